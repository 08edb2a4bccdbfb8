#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "mesh/triangle_mesh.h"

namespace colmap_ext {

// The order of points along a Morton (z-order) curve through their bounding
// box: points that are close in it lie close. The box has 2^53 cells an axis,
// so that points far off do not collapse the others into a few of them. Points
// of one cell are ordered by x, y, z, then by their indices.
// \return [points] indices
// \pre all positions are finite
std::vector<uint32_t> OrderAlongCurve(
    const std::vector<Eigen::Vector3f>& points);

// Puts a mesh's vertices in their order along the curve, and its facets in that
// of their first vertices: what is near on the surface is near in memory then.
// \return [V] the index that each vertex had
// \pre all vertices are finite; facet indices are in range
std::vector<uint32_t> SortAlongCurve(TriangleMesh* mesh);

}  // namespace colmap_ext
