#pragma once

#include <Eigen/Core>

#include "scene/view.h"

namespace colmap_ext {

// Returns a camera at `eye` that looks at `target`, which is shown in the
// middle of the image, with `up` upwards in the image. Where `up` is parallel
// to the camera's axis, it is any direction.
// \param eye, target  world frame, scene units
// \param width, height, focal_length  px
// \pre eye != target
View LookAtView(const Eigen::Vector3d& eye, const Eigen::Vector3d& target,
                const Eigen::Vector3d& up, int width, int height,
                double focal_length);

}  // namespace colmap_ext
