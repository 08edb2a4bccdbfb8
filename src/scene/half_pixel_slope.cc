#include "scene/half_pixel_slope.h"

#include <cmath>
#include <limits>
#include <optional>

#include <Eigen/Eigenvalues>

#include "base/percentile.h"
#include "scene/point_tree.h"

namespace colmap_ext {
namespace {

// The plane through this many fused points stands for the surface at a sparse
// point.
constexpr size_t kNumNeighbors = 16;

// More sparse points than this do not make the slope any more certain.
constexpr size_t kMaxSparsePoints = 20000;

// Fewer say nothing.
constexpr size_t kMinSparsePoints = 30;

// A sparse point's distance from the fused surface along its normal, and the
// distance that the half pixel predicts there.
struct Sample {
  double predicted;
  double observed;
};

// Nothing where the sparse point lies beside the fused surface, or further from
// it than any error of stereo: on what was left out of the fusion.
std::optional<Sample> SampleAt(const PointTree& tree, const PointCloud& cloud,
                               const std::vector<Eigen::Vector3f>& offsets,
                               const Eigen::Vector3f& sparse_point) {
  constexpr double kMaxOffsets = 10;  // 5 px
  const std::vector<uint32_t> neighbors = tree.Nearest(
      sparse_point, kNumNeighbors, std::numeric_limits<float>::infinity());
  if (neighbors.size() < kNumNeighbors) {  // too far, or not finite
    return std::nullopt;
  }
  const auto count = static_cast<double>(neighbors.size());
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
  for (const uint32_t neighbor : neighbors) {
    mean += cloud.positions[neighbor].cast<double>();
    offset += offsets[neighbor].cast<double>();
  }
  mean /= count;
  offset /= count;
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const uint32_t neighbor : neighbors) {
    const Eigen::Vector3d d = cloud.positions[neighbor].cast<double>() - mean;
    scatter += d * d.transpose();
  }
  const Eigen::Vector3d normal =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter)
          .eigenvectors()
          .col(0);
  const Eigen::Vector3d away = sparse_point.cast<double>() - mean;
  const double observed = normal.dot(away);
  const double beside_squared = (away - observed * normal).squaredNorm();
  // Of a disk that the neighbors fill.
  const double radius_squared = 2 * scatter.trace() / count;
  if (beside_squared > radius_squared ||
      std::abs(observed) > kMaxOffsets * offset.norm()) {
    return std::nullopt;
  }
  return Sample{normal.dot(offset), observed};
}

// Leaves out sparse points that lie far from the fused surface: more than three
// standard deviations, estimated by the median.
void DropOutliers(std::vector<Sample>* samples) {
  std::vector<double> distances;
  for (const Sample& sample : *samples) {
    distances.push_back(std::abs(sample.observed));
  }
  // Of normal numbers, half lie within 1 / 1.4826 standard deviations, the
  // distribution's quantile of 3/4.
  constexpr double kSigmasOfMedian = 3 * 1.4826;
  const double max_distance = kSigmasOfMedian * Percentile(50, &distances);
  std::erase_if(*samples, [&](const Sample& sample) {
    return std::abs(sample.observed) > max_distance;
  });
}

}  // namespace

HalfPixelSlope RegressHalfPixel(
    const PointCloud& cloud, const std::vector<Eigen::Vector3f>& offsets,
    const std::vector<Eigen::Vector3f>& sparse_points) {
  HalfPixelSlope result;
  if (cloud.size() < kNumNeighbors || sparse_points.size() < kMinSparsePoints) {
    return result;
  }
  const PointTree tree(cloud.positions);
  const size_t stride =
      (sparse_points.size() + kMaxSparsePoints - 1) / kMaxSparsePoints;
  std::vector<Sample> samples;
  for (size_t i = 0; i < sparse_points.size(); i += stride) {
    if (const auto sample = SampleAt(tree, cloud, offsets, sparse_points[i])) {
      samples.push_back(*sample);
    }
  }
  if (samples.size() < kMinSparsePoints) {
    return result;
  }
  DropOutliers(&samples);
  double predicted_squared = 0;
  double product = 0;
  for (const Sample& sample : samples) {
    predicted_squared += sample.predicted * sample.predicted;
    product += sample.predicted * sample.observed;
  }
  if (samples.size() < kMinSparsePoints || !(predicted_squared > 0)) {
    return result;
  }
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

double CalibratedScale(const HalfPixelSlope& slope) {
  // Stereo that does as COLMAP's does is off by half a pixel, give or take as
  // much as the window's weights shift it.
  constexpr double kNominal = 1;
  constexpr double kNominalError = 0.5;
  // Curvature biases the slope: on a scene of known truth where it is 1.81 the
  // sparse points show 1.91.
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
