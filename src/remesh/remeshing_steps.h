#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "remesh/anchored_mesh.h"

namespace colmap_ext {

// Splits edges at their middles, the longest first, as long as any is more than
// `max_ratio` times as long as is wanted.
// \return the number of edges split
size_t SplitLongEdges(const ReferenceSurface& reference, float max_ratio,
                      AnchoredMesh* mesh);

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

// Flips edges where this brings the numbers of edges at their four vertices
// closer to 6 (4 at a border), and keeps to the reference [Botsch2004].
// \return the number of flips
size_t FlipForValence(const ReferenceSurface& reference, AnchoredMesh* mesh);

// Flips edges where this makes the smallest angle of their two facets larger,
// and keeps to the reference.
// \param min_cosine  of that angle, in [0, 1]: edges of facets with better ones
//        stay.
// \return the number of flips
size_t FlipForAngles(const ReferenceSurface& reference, float min_cosine,
                     AnchoredMesh* mesh);

// Moves each vertex within the reference towards the centroid of the facets
// around it, so that their sizes become those that are wanted [Botsch2004];
// half as far, and then not at all, where a facet would turn over, become worse
// than thin, or leave the reference. Vertices of a border stay.
// \param is_chosen [V] which ones move; empty: all.
void RelaxVertices(const ReferenceSurface& reference,
                   const std::vector<uint8_t>& is_chosen, AnchoredMesh* mesh);

}  // namespace colmap_ext
