#pragma once

#include <cstdint>
#include <vector>

#include "mesh/fixed_vertices.h"
#include "mesh/triangle_mesh.h"

namespace colmap_ext {

// [V] the vertex that one that stays was at the start, or kNone; empty
// where none stays.
using FixedSources = std::vector<uint32_t>;

// \param fixed  of a mesh of so many vertices, or empty
inline FixedSources SourcesOf(const FixedVertices& fixed, size_t num_vertices) {
  FixedSources sources;
  for (uint32_t i = 0; !fixed.empty() && i < num_vertices; ++i) {
    sources.push_back(IsFixed(fixed, i) ? i : kNone);
  }
  return sources;
}

inline FixedVertices FixedOf(const FixedSources& sources) {
  FixedVertices fixed;
  for (const uint32_t source : sources) {
    fixed.push_back(source != kNone ? 1 : 0);
  }
  return fixed;
}

// Those of a mesh that a step made.
// \param step [V] the vertex before the step, where it stayed
inline FixedSources CarrySources(const FixedSources& before,
                                 const FixedSources& step) {
  FixedSources sources;
  for (const uint32_t vertex : step) {
    sources.push_back(vertex != kNone ? before[vertex] : kNone);
  }
  return sources;
}

}  // namespace colmap_ext
