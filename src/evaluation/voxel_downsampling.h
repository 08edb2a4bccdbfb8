#pragma once

#include <vector>

#include <Eigen/Core>

namespace colmap_ext {

// Reduces points to one for each voxel of a grid through the origin, the one
// nearest to the voxel's centre. Which points remain, and in which order, does
// not depend on the order of the given ones.
//
// DTU's evaluation [Jensen2014] instead takes points in random order and drops
// all within the spacing of each; the density is nearly the same, without the
// chance.
//
// \param spacing  side of the voxels, scene units, > 0
// \param points  [P], scene units
// \throw std::invalid_argument if a point is more than 2^31 voxels from the
//        origin on an axis, or not finite
void DownsampleByVoxels(double spacing, std::vector<Eigen::Vector3f>* points);

}  // namespace colmap_ext
