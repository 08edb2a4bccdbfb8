#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mesh/triangle_mesh.h"

namespace colmap_ext {

// What lies around each vertex, as compressed sparse rows. Corner 3 * facet + k
// is corner k of the facet.
struct VertexRings {
  std::vector<uint64_t> neighbor_offsets{0};  // [V + 1], into neighbors
  std::vector<uint32_t> neighbors;            // the vertices that share an edge
                                              // with it, ascending
  std::vector<uint64_t> corner_offsets{0};    // [V + 1], into corners
  std::vector<uint32_t> corners;              // [3 F] those at it, ascending
  std::vector<uint8_t> is_border;             // [V] whether it is at an edge of
                                              // one facet only

  size_t NumVertices() const { return is_border.size(); }

  std::span<const uint32_t> Neighbors(size_t vertex) const {
    return {neighbors.data() + neighbor_offsets[vertex],
            neighbors.data() + neighbor_offsets[vertex + 1]};
  }

  std::span<const uint32_t> Corners(size_t vertex) const {
    return {corners.data() + corner_offsets[vertex],
            corners.data() + corner_offsets[vertex + 1]};
  }
};

// The rows of vertices that no facet uses are empty.
// \pre facet indices are in range, no facet repeats a vertex
VertexRings MakeVertexRings(const TriangleMesh& mesh);

}  // namespace colmap_ext
