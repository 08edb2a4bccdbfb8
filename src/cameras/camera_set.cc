#include "cameras/camera_set.h"

#include <algorithm>
#include <numeric>

#include <tbb/parallel_for.h>
#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>

#include "base/percentile.h"

namespace colmap_ext {
namespace {

// [Umeyama1991, equations (40) to (42)], with weights.
Similarity AlignWeighted(const std::vector<Eigen::Vector3d>& from,
                         const std::vector<Eigen::Vector3d>& to,
                         const std::vector<double>& weights, bool has_scale) {
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
  const Eigen::JacobiSVD<Eigen::Matrix3d, Eigen::NoQRPreconditioner> svd(
      covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d& u = svd.matrixU();
  const Eigen::Matrix3d& v = svd.matrixV();
  const Eigen::Vector3d signs(1, 1,
                              u.determinant() * v.determinant() < 0 ? -1 : 1);
  Similarity similarity;
  similarity.rotation = u * signs.asDiagonal() * v.transpose();
  if (has_scale) {
    similarity.scale =
        similarity.rotation.cwiseProduct(covariance).sum() / variance;
  }
  similarity.translation =
      mean_to - similarity.scale * (similarity.rotation * mean_from);
  return similarity;
}

Eigen::Matrix3d CrossMatrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d matrix;
  matrix << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return matrix;
}

// The derivative of View::ImageFromCam() by the point, px / scene unit.
Eigen::Matrix<double, 2, 3> ProjectionJacobian(const View& view,
                                               const Eigen::Vector3d& p) {
  Eigen::Matrix<double, 2, 3> jacobian;
  jacobian << view.fx / p.z(), 0, -view.fx * p.x() / (p.z() * p.z()),  //
      0, view.fy / p.z(), -view.fy * p.y() / (p.z() * p.z());
  return jacobian;
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

RelativePose::RelativePose(const View& view, const View& leader)
    : rotation(view.cam_from_world_rotation *
               leader.cam_from_world_rotation.transpose()),
      translation(view.cam_from_world_translation -
                  rotation * leader.cam_from_world_translation) {}

void FollowLeaders(const CameraSet& original, std::vector<View>* views) {
  for (size_t i = 0; i < original.leaders.size(); ++i) {
    const uint32_t leader = original.leaders[i];
    if (leader == i) {
      continue;
    }
    const RelativePose pose(original.views[i], original.views[leader]);
    const View& led_by = (*views)[leader];
    View& view = (*views)[i];
    // By way of a quaternion, so that rounding leaves a rotation.
    view.cam_from_world_rotation =
        Eigen::Quaterniond(pose.rotation * led_by.cam_from_world_rotation)
            .normalized()
            .toRotationMatrix();
    view.cam_from_world_translation =
        pose.rotation * led_by.cam_from_world_translation + pose.translation;
  }
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

// In the frame of i the pixel's ray is q, z(q) = 1, and the point p = z q. As
// the camera makes the step (w, v), the point that stays on the ray moves by
// R_i^T (p x w - v) in the world, and along the ray back to the plane, which
// together is the projection along the ray onto the plane.
ShiftJacobian ComputeShiftJacobian(const View& view_i, const View& view_j,
                                   const Eigen::Vector3d& point,
                                   const Eigen::Vector3d& normal) {
  const Eigen::Vector3d p = view_i.CamFromWorld(point);
  const Eigen::Vector3d in_j = view_j.CamFromWorld(point);
  const Eigen::Matrix3d world_from_i =
      view_i.cam_from_world_rotation.transpose();
  const Eigen::Vector3d ray = world_from_i * (p / p.z());
  const double facing = normal.dot(ray);
  const Eigen::Matrix3d onto_plane =
      Eigen::Matrix3d::Identity() - ray * normal.transpose() / facing;
  const Eigen::Matrix<double, 2, 3> by_j = ProjectionJacobian(view_j, in_j);
  const Eigen::Matrix<double, 2, 3> by_point =
      by_j * view_j.cam_from_world_rotation;
  const Eigen::Matrix<double, 2, 3> by_point_in_i =
      by_point * onto_plane * world_from_i;

  ShiftJacobian jacobian;
  jacobian.pixel_j = view_j.ImageFromCam(in_j);
  jacobian.by_pose_i << by_point_in_i * CrossMatrix(p), -by_point_in_i;
  jacobian.by_pose_j << -by_j * CrossMatrix(in_j), by_j;
  jacobian.by_displacement = by_point * ray / facing;
  jacobian.by_pixel_i.col(0) = by_point_in_i.col(0) * (p.z() / view_i.fx);
  jacobian.by_pixel_i.col(1) = by_point_in_i.col(1) * (p.z() / view_i.fy);
  // A longer focal length and a moved principal point turn the pixel's ray.
  jacobian.by_intrinsics_i << -by_point_in_i.leftCols<2>() * p.head<2>(),
      -by_point_in_i.leftCols<2>() * p.z();
  const Eigen::Vector2d from_center =
      jacobian.pixel_j - Eigen::Vector2d(view_j.cx, view_j.cy);
  jacobian.by_intrinsics_j << from_center.x(), view_j.fx, 0,  //
      from_center.y(), 0, view_j.fy;
  return jacobian;
}

Similarity AlignPoints(const std::vector<Eigen::Vector3d>& from,
                       const std::vector<Eigen::Vector3d>& to,
                       const std::vector<double>& footprints, bool has_scale) {
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
    similarity = AlignWeighted(from, to, weights, has_scale);
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

SparseTracks ChooseTracks(const SparseTracks& tracks, size_t num_views,
                          size_t min_observations_per_view) {
  std::vector<size_t> order(tracks.positions.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::ranges::stable_sort(order, [&](size_t a, size_t b) {
    return tracks.observations[a].size() > tracks.observations[b].size();
  });
  std::vector<size_t> counts(num_views, 0);
  SparseTracks chosen;
  for (const size_t i : order) {
    const auto seen = tracks.observations[i];
    const bool is_wanted =
        seen.size() >= 2 &&
        std::ranges::any_of(seen, [&](const auto& observation) {
          return counts[observation.view] < min_observations_per_view;
        });
    if (is_wanted) {
      chosen.positions.push_back(tracks.positions[i]);
      chosen.observations.AddRow(seen);
      for (const TrackObservation& observation : seen) {
        ++counts[observation.view];
      }
    }
  }
  return chosen;
}

std::vector<Eigen::Vector3d> LocateTracks(const SparseTracks& tracks,
                                          const std::vector<View>& views,
                                          const std::vector<double>& sigmas,
                                          double point_sigma) {
  constexpr int kIterations = 10;
  std::vector<Eigen::Vector3d> positions = tracks.positions;
  tbb::parallel_for(size_t{0}, positions.size(), [&](size_t i) {
    Eigen::Vector3d& position = positions[i];
    for (int iteration = 0; iteration < kIterations; ++iteration) {
      Eigen::Matrix3d matrix = Eigen::Matrix3d::Zero();  // normal equations
      Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
      double footprint = 0;  // the largest, scene units
      for (const TrackObservation& seen : tracks.observations[i]) {
        const View& view = views[seen.view];
        const double sigma = sigmas[seen.view];
        const Eigen::Vector3d p = view.CamFromWorld(position);
        if (!(p.z() > 0)) {
          continue;
        }
        const Eigen::Matrix<double, 2, 3> by_point =
            ProjectionJacobian(view, p) *
            (view.cam_from_world_rotation / sigma);
        const Eigen::Vector2d residual =
            (view.ImageFromCam(p) - seen.pixel) / sigma;
        const double weight = RobustWeight(residual.squaredNorm());
        matrix += weight * by_point.transpose() * by_point;
        gradient += weight * by_point.transpose() * residual;
        footprint = std::max(footprint, p.z() / view.fx);
      }
      if (!(footprint > 0)) {
        return;
      }
      const double scale = point_sigma * footprint;
      matrix.diagonal().array() += 1 / (scale * scale);
      gradient += (position - tracks.positions[i]) / (scale * scale);
      position -= matrix.ldlt().solve(gradient);
    }
  });
  return positions;
}

}  // namespace colmap_ext
