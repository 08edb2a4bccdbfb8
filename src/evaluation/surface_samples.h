#pragma once

#include <vector>

#include <Eigen/Core>

#include "mesh/triangle_mesh.h"

namespace colmap_ext {

// Points on the facets of a mesh such that no point of them is farther than the
// spacing from one: each facet is halved at its longest side, and its halves
// likewise, until the middle of each is near enough to its corners.
//
// \param spacing  scene units, > 0
// \throw std::invalid_argument if that would be more than about 10^9 points.
std::vector<Eigen::Vector3f> SampleSurface(const TriangleMesh& mesh,
                                           double spacing);

}  // namespace colmap_ext
