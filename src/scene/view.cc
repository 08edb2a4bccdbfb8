#include "scene/view.h"

#include <Eigen/Geometry>

namespace colmap_ext {

View LookAtView(const Eigen::Vector3d& eye, const Eigen::Vector3d& target,
                const Eigen::Vector3d& up, int width, int height,
                double focal_length) {
  constexpr double kParallel = 1e-9;  // lengths of `up`
  View view;
  view.width = width;
  view.height = height;
  view.fx = view.fy = focal_length;
  view.cx = 0.5 * width;
  view.cy = 0.5 * height;
  const Eigen::Vector3d forward = (target - eye).normalized();
  Eigen::Vector3d right = forward.cross(up);
  if (right.norm() <= kParallel * up.norm()) {
    right = forward.unitOrthogonal();
  }
  right.normalize();
  view.cam_from_world_rotation.row(0) = right;
  view.cam_from_world_rotation.row(1) = forward.cross(right);
  view.cam_from_world_rotation.row(2) = forward;
  view.cam_from_world_translation = -view.cam_from_world_rotation * eye;
  return view;
}

}  // namespace colmap_ext
