#include "mesh/half_edges.h"

#include <numeric>

#include "base/index_limit.h"

namespace colmap_ext {

CornerRows CornersByVertex(const std::vector<Facet>& facets) {
  CornerRows rows;
  for (const Facet& facet : facets) {
    for (const uint32_t vertex : facet) {
      if (vertex >= rows.ends.size()) {
        rows.ends.resize(vertex + 1, 0);
      }
      ++rows.ends[vertex];
    }
  }
  // Where rows begin, which become ends as they are filled.
  std::exclusive_scan(rows.ends.begin(), rows.ends.end(), rows.ends.begin(),
                      uint32_t{0});
  rows.corners.resize(ExpectIndexable(3 * facets.size(), "half-edges"));
  uint32_t corner = 0;
  for (const Facet& facet : facets) {
    for (const uint32_t vertex : facet) {
      rows.corners[rows.ends[vertex]++] = corner++;
    }
  }
  return rows;
}

std::vector<uint32_t> PairHalfEdges(const std::vector<Facet>& facets) {
  std::vector<uint32_t> partners(3 * facets.size(), kNone);
  ForEachEdge(facets, [&](auto first, auto last) {
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
