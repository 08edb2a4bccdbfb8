#pragma once

#include <vector>

#include <Eigen/Core>

namespace colmap_ext {

// Reduces points to one for each cube of a grid through the origin, the one
// nearest to the cube's centre. What remains, and its order, depend on the
// points alone and not on theirs.
//
// DTU's evaluation instead takes points in random order and drops all within
// the spacing of each; the density is nearly the same, without the chance.
//
// \param spacing  side of the cubes, scene units, > 0
// \throw std::invalid_argument if the grid has more than 2^31 cubes a side.
void Thin(double spacing, std::vector<Eigen::Vector3f>* points);

}  // namespace colmap_ext
