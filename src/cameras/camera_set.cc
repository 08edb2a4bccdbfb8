#include "cameras/camera_set.h"

#include <cmath>
#include <cstddef>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>

#include "base/percentile.h"

namespace colmap_ext {

namespace {

// [Umeyama1991, equations (40) to (42)], with weights.
Similarity AlignWeighted(const std::vector<Eigen::Vector3d>& from,
                         const std::vector<Eigen::Vector3d>& to,
                         const std::vector<double>& weights) {
  double sum = 0;
  Eigen::Vector3d mean_from = Eigen::Vector3d::Zero();
  Eigen::Vector3d mean_to = Eigen::Vector3d::Zero();
  for (size_t i = 0; i < from.size(); ++i) {
    sum += weights[i];
    mean_from += weights[i] * from[i];
    mean_to += weights[i] * to[i];
  }
  mean_from /= sum;
  mean_to /= sum;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double variance = 0;
  for (size_t i = 0; i < from.size(); ++i) {
    const Eigen::Vector3d centered = from[i] - mean_from;
    covariance += weights[i] * (to[i] - mean_to) * centered.transpose();
    variance += weights[i] * centered.squaredNorm();
  }
  // Of dynamic size: GCC 12 warns of the fixed one's members.
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(
      covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d u = svd.matrixU();
  const Eigen::Matrix3d v = svd.matrixV();
  const Eigen::Vector3d values = svd.singularValues();
  const Eigen::Vector3d signs(1, 1,
                              u.determinant() * v.determinant() < 0 ? -1 : 1);
  Similarity similarity;
  similarity.rotation = u * signs.asDiagonal() * v.transpose();
  similarity.scale = values.dot(signs) / variance;
  similarity.translation =
      mean_to - similarity.scale * (similarity.rotation * mean_from);
  return similarity;
}

}  // namespace

View MoveView(const View& view, const PoseStep& pose,
              const IntrinsicsStep& intrinsics) {
  View moved = view;
  const Eigen::Vector3d vector = pose.head<3>();
  const double angle = vector.norm();
  if (angle > 0) {
    const Eigen::AngleAxisd turn(angle, vector / angle);
    // By way of a quaternion, so that rounding leaves a rotation.
    moved.cam_from_world_rotation =
        (Eigen::Quaterniond(turn) *
         Eigen::Quaterniond(view.cam_from_world_rotation))
            .normalized()
            .toRotationMatrix();
    moved.cam_from_world_translation = turn * view.cam_from_world_translation;
  }
  moved.cam_from_world_translation += pose.tail<3>();
  const double scale = std::exp(intrinsics[0]);
  moved.fx *= scale;
  moved.fy *= scale;
  moved.cx += intrinsics[1] * view.fx;
  moved.cy += intrinsics[2] * view.fy;
  return moved;
}

PoseStep StepBetween(const View& from, const View& to) {
  const Eigen::AngleAxisd turn(Eigen::Quaterniond(
      to.cam_from_world_rotation * from.cam_from_world_rotation.transpose()));
  PoseStep step;
  step.head<3>() = turn.angle() * turn.axis();
  step.tail<3>() =
      to.cam_from_world_translation - turn * from.cam_from_world_translation;
  return step;
}

Similarity AlignPoints(const std::vector<Eigen::Vector3d>& from,
                       const std::vector<Eigen::Vector3d>& to,
                       const std::vector<double>& footprints) {
  constexpr size_t kMinPoints = 10;  // three determine it
  constexpr int kIterations = 10;
  std::vector<double> weights;
  size_t num_used = 0;
  for (const double footprint : footprints) {
    weights.push_back(footprint > 0 ? 1 / (footprint * footprint) : 0);
    num_used += footprint > 0 ? 1 : 0;
  }
  if (num_used < kMinPoints) {
    return {};
  }
  Similarity similarity;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    similarity = AlignWeighted(from, to, weights);
    std::vector<double> distances;  // footprints
    for (size_t i = 0; i < from.size(); ++i) {
      if (footprints[i] > 0) {
        distances.push_back((similarity(from[i]) - to[i]).norm() /
                            footprints[i]);
      }
    }
    std::vector<double> sorted = distances;
    const double scale = 2 * Median(&sorted);
    if (!(scale > 0)) {
      break;
    }
    size_t next = 0;
    for (size_t i = 0; i < from.size(); ++i) {
      if (footprints[i] > 0) {
        const double ratio = distances[next++] / scale;
        weights[i] = 1 / (footprints[i] * footprints[i] * (1 + ratio * ratio));
      }
    }
  }
  return similarity;
}

View TransformView(const Similarity& similarity, const View& view) {
  View moved = view;
  // By way of a quaternion, so that rounding leaves a rotation.
  moved.cam_from_world_rotation =
      Eigen::Quaterniond(view.cam_from_world_rotation *
                         similarity.rotation.transpose())
          .normalized()
          .toRotationMatrix();
  moved.cam_from_world_translation =
      similarity.scale * view.cam_from_world_translation -
      moved.cam_from_world_rotation * similarity.translation;
  return moved;
}

}  // namespace colmap_ext
