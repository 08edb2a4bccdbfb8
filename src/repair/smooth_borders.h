#pragma once

#include <cstdint>
#include <vector>

#include "mesh/triangle_mesh.h"

namespace colmap_ext {

// Smooths borders along themselves: a vertex where two of the given half-edges
// meet, and no other border, moves halfway to the middle of its two neighbors
// on the border, five times in turn. A vertex stays where a facet would turn by
// more than 60 degrees, and is back where it was where facets would intersect
// that did not.
// \param is_moved [3 F] the half-edges at the border that is smoothed
// \pre the mesh is manifold
void SmoothBorders(const std::vector<uint8_t>& is_moved, TriangleMesh* mesh);

}  // namespace colmap_ext
