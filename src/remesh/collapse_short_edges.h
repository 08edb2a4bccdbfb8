#pragma once

#include <cstddef>

#include "remesh/anchored_mesh.h"

namespace colmap_ext {

// Collapses edges, the shortest first, that are less than `min_ratio` times as
// long as is wanted, where this makes no edge longer than `max_ratio` times
// what is wanted, turns no facet over and keeps to the reference. The vertices
// of a border stay on it.
// \return the number of edges collapsed
size_t CollapseShortEdges(const ReferenceSurface& reference, float min_ratio,
                          float max_ratio, AnchoredMesh* mesh);

// Collapses the shortest edges of needles, facets with an angle of less than 15
// degrees, whatever their length, under the same conditions.
// \return the number of edges collapsed
size_t CollapseNeedles(const ReferenceSurface& reference, float max_ratio,
                       AnchoredMesh* mesh);

}  // namespace colmap_ext
