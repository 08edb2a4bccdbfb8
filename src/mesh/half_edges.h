#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include <tbb/parallel_sort.h>

#include "mesh/triangle_mesh.h"

namespace colmap_ext {

inline uint32_t FromVertex(const std::vector<Facet>& facets, uint32_t half) {
  return facets[half / 3][half % 3];
}

inline uint32_t ToVertex(const std::vector<Facet>& facets, uint32_t half) {
  return facets[half / 3][(half % 3 + 1) % 3];
}

// All half-edges with the undirected edge they run, its vertices packed into 64
// bits, lower one first: sorted, so that those of one edge stand together.
inline std::vector<std::pair<uint64_t, uint32_t>> SortedHalfEdges(
    const std::vector<Facet>& facets) {
  std::vector<std::pair<uint64_t, uint32_t>> halves(3 * facets.size());
  for (uint32_t half = 0; half < halves.size(); ++half) {
    const uint64_t from = FromVertex(facets, half);
    const uint64_t to = ToVertex(facets, half);
    halves[half] = {std::min(from, to) << 32 | std::max(from, to), half};
  }
  tbb::parallel_sort(halves.begin(), halves.end());
  return halves;
}

// Calls function(first, last) for the half-edges of each edge.
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

}  // namespace colmap_ext
