#pragma once

#include <cstdint>
#include <vector>

#include "mesh/triangle_mesh.h"
#include "mesh/vertex_rings.h"
#include "spatial/self_intersections.h"

namespace colmap_ext {

// Returns the facets of the pairs in groups, ascending in each, the group of
// the lowest facet first: facets belong together if they intersect or share a
// vertex.
// \pre facet indices of the pairs are in range
std::vector<std::vector<uint32_t>> CrossingClusters(
    const TriangleMesh& mesh, const std::vector<FacetPair>& pairs);

// Returns the vertices of some facets and of a number of rings of edges around
// them, ascending.
// \pre facet indices are in range
std::vector<uint32_t> VerticesAround(const TriangleMesh& mesh,
                                     const VertexRings& rings,
                                     const std::vector<uint32_t>& facets,
                                     int num_rings);

}  // namespace colmap_ext
