#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "mesh/triangle_mesh.h"

namespace colmap_ext {

// The pairs of facets that run through each other, the lower one first,
// ascending.
//
// Two facets do so where an edge of one, its ends strictly on both sides of the
// other's plane, passes through the other or its border; of facets that share a
// vertex only the edges are looked at that do not end there. Not found are
// - facets that share an edge: they could only be folded onto each other,
// - overlaps within one plane,
// - corners that touch the other facet from one side.
//
// Determinants are taken in double; one that could be of either sign, for its
// rounding, counts as zero.
//
// \pre facet indices are in range, vertices are finite
std::vector<std::array<uint32_t, 2>> FindSelfIntersections(
    const TriangleMesh& mesh);

}  // namespace colmap_ext
