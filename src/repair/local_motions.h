#pragma once

#include <cstdint>
#include <vector>

#include "mesh/triangle_mesh.h"
#include "mesh/vertex_rings.h"
#include "repair/guarded_mesh.h"

namespace colmap_ext {

// Returns where some vertices go by rounds of umbrella smoothing: in each, all
// go half of the way to the mean of their neighbors, of which those that are
// not among the vertices stay. A vertex at a border goes to the mean of its
// neighbors along the border, so that the border stays one; one with other than
// two such neighbors stays.
// \param vertices  ascending
// \pre indices are in range
VertexTargets Smoothed(const TriangleMesh& mesh, const VertexRings& rings,
                       const std::vector<uint32_t>& vertices, int num_rounds);

// Returns where some vertices go along the mean of their facets' normals, by a
// share of the mean length of their edges: all of them outwards or, where the
// share is negative, inwards.
// \param vertices  ascending
// \pre indices are in range
VertexTargets Pushed(const TriangleMesh& mesh, const VertexRings& rings,
                     const std::vector<uint32_t>& vertices, double share);

}  // namespace colmap_ext
