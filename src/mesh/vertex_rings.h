#pragma once

#include <cstdint>
#include <vector>

#include "base/rows.h"
#include "mesh/triangle_mesh.h"

namespace colmap_ext {

// The neighbors and facets of each vertex.
struct VertexRings {
  Rows<uint32_t> neighbors;  // [V] the vertices that share an edge with it,
                             // ascending
  Rows<uint32_t> corners;    // [V] the corners at it, ascending; corner
                             // 3 * facet + k is corner k of the facet
  std::vector<uint8_t> is_border;  // [V] whether it is an end of an edge with
                                   // one facet

  size_t NumVertices() const { return is_border.size(); }
};

// The rows of vertices that no facet uses are empty.
// \pre facet indices are in range, no facet repeats a vertex
VertexRings MakeVertexRings(const TriangleMesh& mesh);

}  // namespace colmap_ext
