#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "scene/view.h"

namespace colmap_ext {

// A camera at `eye` that looks to `target`, which comes to lie in the middle of
// the image. \pre it does not look along the y axis
inline View LookAt(const Eigen::Vector3d& eye, const Eigen::Vector3d& target,
                   int width, int height, double focal_length) {
  View view;
  view.width = width;
  view.height = height;
  view.fx = view.fy = focal_length;
  view.cx = 0.5 * width;
  view.cy = 0.5 * height;
  const Eigen::Vector3d forward = (target - eye).normalized();
  const Eigen::Vector3d right =
      Eigen::Vector3d::UnitY().cross(forward).normalized();
  view.cam_from_world_rotation.row(0) = right;
  view.cam_from_world_rotation.row(1) = forward.cross(right);
  view.cam_from_world_rotation.row(2) = forward;
  view.cam_from_world_translation = -view.cam_from_world_rotation * eye;
  return view;
}

}  // namespace colmap_ext
