#include "scene/region.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include <Eigen/Eigenvalues>

#include "base/percentile.h"

namespace colmap_ext {
namespace {

constexpr size_t kMinPoints = 16;

// The depths of the points in a view's image, scene units; 0: not in it.
std::vector<float> DepthsInImage(const View& view,
                                 const std::vector<Eigen::Vector3f>& points) {
  std::vector<float> depths(points.size(), 0);
  for (size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d point = view.CamFromWorld(points[i].cast<double>());
    if (!(point.z() > 0)) {
      continue;
    }
    const Eigen::Vector2d pixel = view.ImageFromCam(point);
    if (pixel.x() >= 0 && pixel.x() <= view.width && pixel.y() >= 0 &&
        pixel.y() <= view.height) {
      depths[i] = static_cast<float>(point.z());
    }
  }
  return depths;
}

// [points] how many views look at each.
std::vector<uint32_t> CountViews(const std::vector<View>& views,
                                 const std::vector<Eigen::Vector3f>& points) {
  constexpr float kMaxDepth = 2;  // medians
  std::vector<uint32_t> counts(points.size(), 0);
  for (const View& view : views) {
    const std::vector<float> depths = DepthsInImage(view, points);
    std::vector<float> in_image = depths;
    std::erase(in_image, 0);
    if (in_image.empty()) {
      continue;
    }
    const float max_depth = kMaxDepth * Median(&in_image);
    for (size_t i = 0; i < points.size(); ++i) {
      counts[i] += depths[i] > 0 && depths[i] <= max_depth;
    }
  }
  return counts;
}

// The points that enough views look at.
std::vector<Eigen::Vector3d> WellSeen(
    const std::vector<View>& views,
    const std::vector<Eigen::Vector3f>& points) {
  constexpr double kBestPercent = 90;
  constexpr double kMinShare = 0.5;
  const std::vector<uint32_t> counts = CountViews(views, points);
  std::vector<double> ranked(counts.begin(), counts.end());
  const double best = ranked.empty() ? 0 : Percentile(kBestPercent, &ranked);
  std::vector<Eigen::Vector3d> seen;
  for (size_t i = 0; i < points.size(); ++i) {
    if (counts[i] > 0 && counts[i] >= kMinShare * best) {
      seen.push_back(points[i].cast<double>());
    }
  }
  return seen;
}

// The rows are the principal axes, largest first, right-handed.
Eigen::Matrix3d PrincipalAxes(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& point : points) {
    mean += point / static_cast<double>(points.size());
  }
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& point : points) {
    covariance += (point - mean) * (point - mean).transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  Eigen::Matrix3d axes = solver.eigenvectors().transpose().colwise().reverse();
  if (axes.determinant() < 0) {
    axes.row(2) *= -1;
  }
  return axes;
}

}  // namespace

Region RegionBetween(const Eigen::Vector3d& lower,
                     const Eigen::Vector3d& upper) {
  return {Eigen::Matrix3d::Identity(), (lower + upper) / 2,
          (upper - lower) / 2};
}

Region Grow(const Region& region, double margin) {
  Region grown = region;
  grown.half_sizes.array() += margin;
  return grown;
}

SegmentPart ClipToBox(const Eigen::Vector3d& start, const Eigen::Vector3d& way,
                      const Eigen::Vector3d& lower,
                      const Eigen::Vector3d& upper, SegmentPart part) {
  for (int axis = 0; axis < 3; ++axis) {
    if (way[axis] != 0) {
      const double a = (lower[axis] - start[axis]) / way[axis];
      const double b = (upper[axis] - start[axis]) / way[axis];
      part.first = std::max(part.first, std::min(a, b));
      part.second = std::min(part.second, std::max(a, b));
    } else if (start[axis] < lower[axis] || start[axis] > upper[axis]) {
      return {1, 0};
    }
  }
  return part;
}

SegmentPart PartInside(const Region& region, const Eigen::Vector3d& start,
                       const Eigen::Vector3d& end) {
  const Eigen::Vector3d from = region.FromCenter(start);
  return ClipToBox(from, region.FromCenter(end) - from, -region.half_sizes,
                   region.half_sizes);
}

std::optional<Region> FocusRegion(const std::vector<View>& views,
                                  const std::vector<Eigen::Vector3f>& points) {
  constexpr double kOutlierPercent = 1;  // at each side
  constexpr double kMargin = 0.1;        // of the size, at each side
  const std::vector<Eigen::Vector3d> seen = WellSeen(views, points);
  if (seen.size() < kMinPoints) {
    return std::nullopt;
  }
  const Eigen::Matrix3d axes = PrincipalAxes(seen);
  Eigen::Vector3d lower;
  Eigen::Vector3d upper;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> along;
    for (const Eigen::Vector3d& point : seen) {
      along.push_back(axes.row(axis).dot(point));
    }
    lower[axis] = Percentile(kOutlierPercent, &along);
    upper[axis] = Percentile(100 - kOutlierPercent, &along);
  }
  const Eigen::Vector3d size = upper - lower;
  if (!(size.minCoeff() > 0)) {
    return std::nullopt;
  }
  return Region{axes, axes.transpose() * ((lower + upper) / 2),
                (0.5 + kMargin) * size};
}

}  // namespace colmap_ext
