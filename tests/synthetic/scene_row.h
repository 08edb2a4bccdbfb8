#pragma once

#include <Eigen/Core>

#include "tests/synthetic/dense_scene.h"

namespace colmap_ext::synthetic {

// Copies of a scene side by side, each seen by its own views, whose names begin
// with the number of the copy. Without depth maps and true depths.
// \param offset  from one to the next, scene units
DenseScene MakeSceneRow(const DenseScene& scene, int num_copies,
                        const Eigen::Vector3d& offset);

}  // namespace colmap_ext::synthetic
