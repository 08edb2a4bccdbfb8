#pragma once

#include <vector>

#include <Eigen/Core>

#include "mesh/triangle_mesh.h"

namespace colmap_ext {

// Returns samples of a mesh such that every point of a facet is within the
// spacing of a sample. Facets are bisected recursively at their longest side
// until each part's centroid is close enough to its corners.
//
// \param spacing  scene units, > 0
// \pre facet indices are in range, vertices are finite
// \throw std::invalid_argument for more than about 10^9 samples
std::vector<Eigen::Vector3f> SampleSurface(const TriangleMesh& mesh,
                                           double spacing);

// Keeps one point for each voxel of a grid through the origin: the one nearest
// to the voxel's center. The result does not depend on the order of the points.
//
// DTU's evaluation [Jensen2014] instead visits points in random order and drops
// all others within the spacing; the density is nearly the same, without
// randomness.
//
// \param spacing  side of the voxels, scene units, > 0
// \param points  [P], scene units
// \throw std::invalid_argument if a point is more than 2^31 voxels from the
//        origin on an axis, or not finite
void DownsampleByVoxels(double spacing, std::vector<Eigen::Vector3f>* points);

}  // namespace colmap_ext
