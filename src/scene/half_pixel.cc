#include "scene/half_pixel.h"

#include <cmath>
#include <limits>

#include <tbb/parallel_for.h>
#include <Eigen/Eigenvalues>

#include "base/percentile.h"
#include "base/rows.h"
#include "scene/point_tree.h"

namespace colmap_ext {
namespace {

// The plane through this many fused points stands for the surface at a sparse
// point. A choice: enough for a normal, few enough for the plane to be local.
constexpr size_t kNumNeighbors = 16;

// More sparse points do not make the slope more certain than kSlopeBias.
constexpr size_t kMaxSparsePoints = 20000;

// Fewer say nothing. A choice.
constexpr size_t kMinSparsePoints = 30;

// A sparse point's distance from the fused surface along its normal, and the
// distance that the half pixel predicts there. Scene units.
struct Sample {
  double predicted;
  double observed;
};

// No sample where the sparse point lies beside the fused surface, or farther
// from it than any error of stereo: on what was left out of the fusion.
void AppendSample(const PointTree& tree, const PointCloud& cloud,
                  const std::vector<Eigen::Vector3f>& offsets,
                  const Eigen::Vector3f& sparse_point,
                  std::vector<Sample>* samples) {
  // Norms of the mean offset, which is half a pixel in x and in y: 7 px if the
  // views agree, less if they differ. A choice.
  constexpr double kMaxOffsets = 10;
  const std::vector<uint32_t> neighbors = tree.Nearest(
      sparse_point, kNumNeighbors, std::numeric_limits<float>::infinity());
  if (neighbors.size() < kNumNeighbors) {  // too far, or not finite
    return;
  }
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
  for (const uint32_t point : neighbors) {
    mean += cloud.positions[point].cast<double>() / kNumNeighbors;
    offset += offsets[point].cast<double>() / kNumNeighbors;
  }
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const uint32_t point : neighbors) {
    const Eigen::Vector3d d = cloud.positions[point].cast<double>() - mean;
    scatter += d * d.transpose();
  }
  const Eigen::Vector3d normal =  // of the plane of least squares
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter)
          .eigenvectors()
          .col(0);
  // Of a disk that the neighbors would fill evenly.
  const double radius_squared = 2 * scatter.trace() / kNumNeighbors;
  const Eigen::Vector3d away = sparse_point.cast<double>() - mean;
  const double observed = normal.dot(away);
  const double beside_squared = (away - observed * normal).squaredNorm();
  if (beside_squared <= radius_squared &&
      std::abs(observed) <= kMaxOffsets * offset.norm()) {
    samples->push_back({normal.dot(offset), observed});
  }
}

// Leaves out sparse points that lie farther from the fused surface than three
// standard deviations of such a distance around zero, by the median.
void DropOutliers(std::vector<Sample>* samples) {
  std::vector<double> distances;
  for (const Sample& sample : *samples) {
    distances.push_back(std::abs(sample.observed));
  }
  // Half of all normal numbers lie within 1 / 1.4826 standard deviations.
  constexpr double kSigmasOfMedian = 3 * 1.4826;
  const double max_distance = kSigmasOfMedian * Percentile(50, &distances);
  std::erase_if(*samples, [&](const Sample& sample) {
    return std::abs(sample.observed) > max_distance;
  });
}

// The line of least squares through the origin.
HalfPixelSlope Regress(const std::vector<Sample>& samples) {
  double predicted_squared = 0;
  double product = 0;
  for (const Sample& sample : samples) {
    predicted_squared += sample.predicted * sample.predicted;
    product += sample.predicted * sample.observed;
  }
  if (!(predicted_squared > 0)) {
    return {};
  }
  HalfPixelSlope result;
  result.num_points = samples.size();
  result.slope = product / predicted_squared;
  double residual_squared = 0;
  for (const Sample& sample : samples) {
    const double residual = sample.observed - result.slope * sample.predicted;
    residual_squared += residual * residual;
  }
  result.standard_error =
      std::sqrt(residual_squared / static_cast<double>(samples.size() - 1) /
                predicted_squared);
  return result;
}

}  // namespace

std::vector<Eigen::Vector3f> HalfPixelOffsets(
    const PointCloud& cloud, const std::vector<View>& views,
    const std::vector<double>& depth_map_scales) {
  std::vector<Eigen::Vector3f> offsets(cloud.size(), Eigen::Vector3f::Zero());
  tbb::parallel_for(size_t{0}, cloud.size(), [&](size_t point) {
    const auto seen_by = cloud.views[point];
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const uint32_t index : seen_by) {
      const View& view = views[index];
      const double scale =
          depth_map_scales.empty() ? 1 : depth_map_scales[index];
      const double depth =
          view.CamFromWorld(cloud.positions[point].cast<double>()).z();
      sum += view.cam_from_world_rotation.transpose() *
             Eigen::Vector3d(0.5 * depth / (view.fx * scale),
                             0.5 * depth / (view.fy * scale), 0);
    }
    if (!seen_by.empty()) {
      offsets[point] =
          (sum / static_cast<double>(seen_by.size())).cast<float>();
    }
  });
  return offsets;
}

HalfPixelSlope RegressHalfPixel(
    const PointCloud& cloud, const std::vector<Eigen::Vector3f>& offsets,
    const std::vector<Eigen::Vector3f>& sparse_points) {
  if (cloud.size() < kNumNeighbors || sparse_points.size() < kMinSparsePoints) {
    return {};
  }
  const PointTree tree(cloud.positions);
  const size_t stride =
      (sparse_points.size() + kMaxSparsePoints - 1) / kMaxSparsePoints;
  std::vector<Sample> samples =
      MakeRows<Sample>((sparse_points.size() + stride - 1) / stride,
                       [&](size_t i, std::vector<Sample>* all) {
                         AppendSample(tree, cloud, offsets,
                                      sparse_points[i * stride], all);
                       })
          .values;
  if (samples.size() >= kMinSparsePoints) {
    DropOutliers(&samples);
  }
  return samples.size() < kMinSparsePoints ? HalfPixelSlope()
                                           : Regress(samples);
}

double CalibratedScale(const HalfPixelSlope& slope) {
  // Stereo like COLMAP's is off by half a pixel, plus or minus a quarter
  // of one by which its windows may shift it. Slopes.
  constexpr double kNominal = 1;
  constexpr double kNominalError = 0.5;
  // Curvature biases the slope. Tuned on: bunny, where sparse points show 1.91
  // and the truth 1.81; by: the rows "calibrated" of docs/experiments.md.
  constexpr double kSlopeBias = 0.1;
  if (slope.num_points == 0) {
    return kNominal;
  }
  const double nominal_weight = 1 / (kNominalError * kNominalError);
  const double slope_weight = 1 / (slope.standard_error * slope.standard_error +
                                   kSlopeBias * kSlopeBias);
  return (nominal_weight * kNominal + slope_weight * slope.slope) /
         (nominal_weight + slope_weight);
}

}  // namespace colmap_ext
