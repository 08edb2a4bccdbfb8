#pragma once

#include <cstdint>
#include <vector>

#include "remesh/anchored_mesh.h"

namespace colmap_ext {

// Moves each vertex within the reference towards the centroid of the facets
// around it, so that their sizes become those that are wanted [Botsch2004];
// half as far, and then not at all, where a facet would turn over, become worse
// than thin, or leave the reference. Vertices of a border stay.
// \param is_chosen [V] which ones move; empty: all.
void RelaxVertices(const ReferenceSurface& reference,
                   const std::vector<uint8_t>& is_chosen, AnchoredMesh* mesh);

}  // namespace colmap_ext
