#pragma once

#include <vector>

#include <Eigen/Core>

#include "scene/view.h"

namespace colmap_ext {

// A camera at `eye` that looks at `target`, the y axis downwards in its image.
inline View LookAt(const Eigen::Vector3d& eye, const Eigen::Vector3d& target,
                   int width, int height, double focal_length) {
  return LookAtView(eye, target, -Eigen::Vector3d::UnitY(), width, height,
                    focal_length);
}

// The views of a scene that is scaled around the origin.
inline std::vector<View> Scaled(std::vector<View> views, double factor) {
  for (View& view : views) {
    view.cam_from_world_translation *= factor;
  }
  return views;
}

}  // namespace colmap_ext
