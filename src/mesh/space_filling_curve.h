#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "mesh/triangle_mesh.h"

namespace colmap_ext {

// Keys of points along a Morton (z-order) curve through their bounding box:
// points whose keys are close lie close. 21 bits an axis, interleaved.
// \pre all positions are finite
std::vector<uint64_t> MortonKeys(const std::vector<Eigen::Vector3f>& points);

// Puts a mesh's vertices in the order of their keys, and its facets in that of
// their first vertices: what is near on the surface is near in memory then.
// \return [V] the index that each vertex had
// \pre all vertices are finite; facet indices are in range
std::vector<uint32_t> SortAlongCurve(TriangleMesh* mesh);

}  // namespace colmap_ext
