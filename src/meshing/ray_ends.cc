#include "meshing/ray_ends.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "scene/depth_maps.h"

namespace colmap_ext {
namespace {

// Whether the pixels around are masked, as far as they are in the image.
bool IsMaskedAround(const GrayImage& mask, int row, int col) {
  constexpr int kRadius = 2;  // px, a choice
  for (int y = std::max(0, row - kRadius);
       y <= std::min(mask.height - 1, row + kRadius); ++y) {
    for (int x = std::max(0, col - kRadius);
         x <= std::min(mask.width - 1, col + kRadius); ++x) {
      if (mask.Row(y)[x] != 0) {
        return false;
      }
    }
  }
  return true;
}

}  // namespace

RayEndCollector::RayEndCollector(const Region& region,
                                 const std::vector<View>& views)
    : region_(region),
      grown_(Grow(region, MarginOf(region))),
      views_(views),
      squares_(views.size()) {}

void RayEndCollector::Add(const Eigen::Vector3f& point,
                          std::span<const uint32_t> views, float weight) {
  for (const uint32_t view : views) {
    AddRay(view, point.cast<double>(), weight);
  }
}

void RayEndCollector::AddRay(uint32_t view_index, const Eigen::Vector3d& point,
                             float weight) {
  const View& view = views_[view_index];
  const Eigen::Vector3d center = view.Center();
  if (PartInside(region_, center, point).IsEmpty()) {
    return;
  }
  const Eigen::Vector3d in_camera = view.CamFromWorld(point);
  if (!(in_camera.z() > 0)) {
    return;
  }
  const Eigen::Vector2d pixel = view.ImageFromCam(in_camera);
  const std::pair<int, int> square = {
      static_cast<int>(std::floor(pixel.x() / kRayEndSpacing)),
      static_cast<int>(std::floor(pixel.y() / kRayEndSpacing))};
  const auto [it, is_new] =
      squares_[view_index].try_emplace(square, ends_.size());
  if (!is_new) {
    ends_[it->second].weight += weight;
    return;
  }
  const double share = PartInside(grown_, center, point).second;
  ends_.push_back(
      {(center + share * (point - center)).cast<float>(), view_index, weight});
}

double MarginOf(const Region& region) {
  constexpr double kShare = 0.05;
  return kShare * 2 * region.half_sizes.norm();
}

void DropPoints(const std::vector<uint8_t>& is_dropped,
                WeightedCloud* weighted) {
  PointCloud& cloud = weighted->cloud;
  const auto shorten = [&](auto* values) {
    std::erase_if(*values, [&](const auto& value) {
      return is_dropped[&value - values->data()] != 0;
    });
  };
  weighted->num_points -=
      static_cast<size_t>(std::ranges::count(is_dropped, 1));
  EditRows(
      [&](size_t i, const auto& row) {
        return is_dropped[i] == 0 ? std::optional(row.size()) : std::nullopt;
      },
      &cloud.views);
  shorten(&cloud.positions);
  shorten(&cloud.colors);
  shorten(&weighted->weights);
}

RayEnds CropCloud(const Region& region, const std::vector<View>& views,
                  WeightedCloud* weighted) {
  RayEndCollector collector(region, views);
  const PointCloud& cloud = weighted->cloud;
  std::vector<uint8_t> is_dropped(cloud.size(), 0);
  for (size_t i = 0; i < cloud.size(); ++i) {
    if (collector.IsOutside(cloud.positions[i])) {
      collector.Add(cloud.positions[i], cloud.views[i], weighted->weights[i]);
      is_dropped[i] = 1;
    }
  }
  DropPoints(is_dropped, weighted);
  return collector.Take();
}

Region RegionOfCloud(const PointCloud& cloud) {
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& position : cloud.positions) {
    box.extend(position);
  }
  return RegionAround(box);
}

Region RegionAround(const Eigen::AlignedBox3f& box) {
  constexpr double kMargin = 0.1;
  Region region =
      RegionBetween(box.min().cast<double>(), box.max().cast<double>());
  region.half_sizes *= 1 + 2 * kMargin;
  return region;
}

RayEnds BackgroundEnds(const Region& region, const View& view,
                       uint32_t view_index, const GrayImage& mask) {
  constexpr int kSpacing = static_cast<int>(kRayEndSpacing);
  const Eigen::Vector3d center = view.Center();
  // Beyond the region, whatever its depth.
  const double length =
      2 * ((region.center - center).norm() + region.half_sizes.norm());
  RayEnds ends;
  for (int row = kSpacing / 2; row < mask.height; row += kSpacing) {
    for (int col = kSpacing / 2; col < mask.width; col += kSpacing) {
      if (!IsMaskedAround(mask, row, col)) {
        continue;
      }
      const Eigen::Vector3d way =
          length *
          RayDirection(view, col + 0.5, row + 0.5).cast<double>().normalized();
      const SegmentPart part = PartInside(region, center, center + way);
      if (!part.IsEmpty()) {
        ends.push_back(
            {(center + part.second * way).cast<float>(), view_index, 1});
      }
    }
  }
  return ends;
}

std::vector<Eigen::Vector3f> DepthRayEnds(const View& view,
                                          const DepthMap& depths) {
  constexpr double kBefore = 4;  // px
  const View scaled = ResizeView(view, depths.width, depths.height);
  DepthMap before = Subsample(depths, kDepthSpacing);
  for (float& depth : before.depths) {
    depth *= static_cast<float>(1 - kBefore / scaled.fx);
  }
  std::vector<Eigen::Vector3f> ends = PointsWhere(before, before, scaled);
  std::erase_if(ends, [](const auto& end) { return !IsMeasurable(end); });
  return ends;
}

void AppendEnds(const RayEnds& ends, WeightedCloud* weighted) {
  PointCloud& cloud = weighted->cloud;
  for (const RayEnd& end : ends) {
    cloud.positions.push_back(end.position);
    cloud.views.AddRow(std::array{end.view});
    weighted->weights.push_back(end.weight);
  }
  if (!cloud.colors.empty()) {
    cloud.colors.resize(cloud.size());
  }
}

std::vector<uint8_t> MarkEnds(const ThinnedPoints& thinned,
                              WeightedCloud* weighted) {
  const size_t num_points = weighted->num_points;
  std::vector<uint8_t> is_end;
  if (num_points == weighted->cloud.size()) {
    return is_end;
  }
  for (const uint32_t point : thinned.vertex_points) {
    is_end.push_back(point >= num_points);
  }
  for (size_t point = 0; point < weighted->cloud.size(); ++point) {
    const bool is_at_end = is_end[thinned.point_vertices[point]] != 0;
    if (is_at_end != (point >= num_points)) {
      weighted->weights[point] = 0;
    }
  }
  return is_end;
}

}  // namespace colmap_ext
