#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

#include "mesh/surface.h"
#include "spatial/self_intersections.h"

namespace colmap_ext {

// \param facets  of the patch, ascending
MeshPart TakePatch(const TriangleMesh& mesh, std::vector<uint32_t> facets);

// Marks all facets at the vertices within some rings of edges around facets.
// Goes through all of the mesh once a ring, and needs no adjacency.
// \return [F] 1: it is one of these
std::vector<uint8_t> MarkAround(const TriangleMesh& mesh,
                                const std::vector<uint32_t>& facets,
                                int num_rings);

// Marks all facets whose boxes meet any of the given ones, too.
void MarkWithin(const TriangleMesh& mesh,
                const std::vector<Eigen::AlignedBox3f>& boxes,
                std::vector<uint8_t>* is_marked);

// Returns the facets of the pairs in groups, ascending in each, the group of
// the lowest facet first: facets belong together if they intersect or share a
// vertex.
// \pre facet indices of the pairs are in range
std::vector<std::vector<uint32_t>> CrossingClusters(
    const TriangleMesh& mesh, const std::vector<FacetPair>& pairs);

}  // namespace colmap_ext
