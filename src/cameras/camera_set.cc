#include "cameras/camera_set.h"

#include <cmath>

#include <Eigen/Geometry>

namespace colmap_ext {

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

}  // namespace colmap_ext
