#include "mesh/half_edges.h"

#include <algorithm>

#include <tbb/parallel_sort.h>

#include "base/index_limit.h"

namespace colmap_ext {

std::vector<std::pair<uint64_t, uint32_t>> SortedHalfEdges(
    const std::vector<Facet>& facets) {
  std::vector<std::pair<uint64_t, uint32_t>> halves(
      ExpectIndexable(3 * facets.size(), "half-edges"));
  for (uint32_t half = 0; half < halves.size(); ++half) {
    const uint64_t from = FromVertex(facets, half);
    const uint64_t to = ToVertex(facets, half);
    halves[half] = {std::min(from, to) << 32 | std::max(from, to), half};
  }
  tbb::parallel_sort(halves.begin(), halves.end());
  return halves;
}

std::vector<uint32_t> PairHalfEdges(const std::vector<Facet>& facets) {
  std::vector<uint32_t> partners(3 * facets.size(), kNoPartner);
  ForEachEdge(SortedHalfEdges(facets), [&](auto first, auto last) {
    const uint32_t half = first->second;
    if (last - first == 2) {
      const uint32_t other = (first + 1)->second;
      if (FromVertex(facets, half) != FromVertex(facets, other)) {
        partners[half] = other;
        partners[other] = half;
      }
    }
  });
  return partners;
}

}  // namespace colmap_ext
