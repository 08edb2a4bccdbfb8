#pragma once

#include <cstdint>
#include <vector>

#include "mesh/triangle_mesh.h"

namespace colmap_ext {

// [V] not 0: the vertex stays, where it is and as it is, and so do edges
// between two of them. Vertices beyond the array are free; empty: all are.
using FixedVertices = std::vector<uint8_t>;

inline bool IsFixed(const FixedVertices& fixed, uint32_t vertex) {
  return vertex < fixed.size() && fixed[vertex] != 0;
}

// Whether all corners of a facet, and with them the facet, stay.
inline bool IsFixed(const FixedVertices& fixed, const Facet& facet) {
  return IsFixed(fixed, facet[0]) && IsFixed(fixed, facet[1]) &&
         IsFixed(fixed, facet[2]);
}

}  // namespace colmap_ext
