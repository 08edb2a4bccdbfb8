#pragma once

#include <Eigen/Core>

#include "scene/view.h"

namespace colmap_ext {

// A camera at `eye` that looks at `target`, the y axis downwards in its image.
inline View LookAt(const Eigen::Vector3d& eye, const Eigen::Vector3d& target,
                   int width, int height, double focal_length) {
  return LookAtView(eye, target, -Eigen::Vector3d::UnitY(), width, height,
                    focal_length);
}

}  // namespace colmap_ext
