#pragma once

#include <vector>

#include <Eigen/Core>

#include "mesh/triangle_mesh.h"

namespace colmap_ext {

// Returns samples of a mesh such that no point of a facet is farther than the
// spacing from a sample: each facet is halved at its longest side, its halves
// likewise, until each part's centroid is near enough to its corners.
//
// \param spacing  scene units, > 0
// \pre facet indices are in range, vertices are finite
// \throw std::invalid_argument if that would be more than about 10^9 samples
std::vector<Eigen::Vector3f> SampleSurface(const TriangleMesh& mesh,
                                           double spacing);

}  // namespace colmap_ext
