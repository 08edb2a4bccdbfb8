#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "mesh/triangle_mesh.h"

namespace colmap_ext {

// Returns the pairs of facets that intersect, the lower index first, ascending.
//
// Two facets intersect if an edge of one has its ends strictly on both sides of
// the other's plane and passes through the other or its border. Of facets that
// share a vertex, edges that end there are left out. Not found are
// - facets that share an edge, which could only be folded onto each other,
// - overlaps within one plane,
// - corners that touch the other facet from one side.
//
// Determinants are doubles; one whose rounding leaves the sign open counts as
// zero.
//
// \pre facet indices are in range, vertices are finite
std::vector<std::array<uint32_t, 2>> FindSelfIntersections(
    const TriangleMesh& mesh);

}  // namespace colmap_ext
