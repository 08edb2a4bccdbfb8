#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "mesh/triangle_mesh.h"

namespace colmap_ext {

// The half-edge 3 * facet + k runs from corner k of the facet to corner k + 1.

inline uint32_t FromVertex(const std::vector<Facet>& facets, uint32_t half) {
  return facets[half / 3][half % 3];
}

inline uint32_t ToVertex(const std::vector<Facet>& facets, uint32_t half) {
  return facets[half / 3][(half % 3 + 1) % 3];
}

// The half-edge after this one in its facet.
inline uint32_t NextHalfEdge(uint32_t half) {
  return half % 3 == 2 ? half - 2 : half + 1;
}

// Returns [3 F] all half-edges, each with its undirected edge: the two vertices
// packed into 64 bits, the lower one first. Sorted, so that the half-edges of
// an edge stand together.
// \throw std::invalid_argument if there are more than 32 bits can number.
std::vector<std::pair<uint64_t, uint32_t>> SortedHalfEdges(
    const std::vector<Facet>& facets);

// Calls function(first, last) for the half-edges of each edge.
// \param halves  from SortedHalfEdges
template <typename Halves, typename Function>
void ForEachEdge(const Halves& halves, const Function& function) {
  for (auto first = halves.begin(); first != halves.end();) {
    auto last = first;
    while (last != halves.end() && last->first == first->first) {
      ++last;
    }
    function(first, last);
    first = last;
  }
}

inline constexpr uint32_t kNoPartner = UINT32_MAX;

// Returns [3 F] the partner of each half-edge: the other one of its edge, where
// exactly two facets share the edge and run it in opposite directions; else
// kNoPartner.
std::vector<uint32_t> PairHalfEdges(const std::vector<Facet>& facets);

}  // namespace colmap_ext
