#include "mesh/adjacency.h"

#include <numeric>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "base/indices.h"

namespace colmap_ext {

Rows<uint32_t> CornersByVertex(const std::vector<Facet>& facets) {
  ExpectIndexable(3 * facets.size(), "half-edges");
  uint32_t num_vertices = 0;
  for (const Facet& facet : facets) {
    num_vertices = std::max(num_vertices, std::ranges::max(facet) + 1);
  }
  return GroupInRows<uint32_t>(num_vertices, [&](const auto& add) {
    uint32_t corner = 0;
    for (const Facet& facet : facets) {
      for (const uint32_t vertex : facet) {
        add(vertex, corner++);
      }
    }
  });
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

namespace {

// Calls function(vertex, others) for each vertex, in parallel: the other
// vertices of the facets at it, ascending, once for each facet.
template <typename Function>
void ForEachVertex(const std::vector<Facet>& facets, const VertexRings& rings,
                   const Function& function) {
  constexpr size_t kGrain = 1024;  // vertices a task; a choice
  tbb::parallel_for(
      tbb::blocked_range<size_t>(0, rings.NumVertices(), kGrain),
      [&](const tbb::blocked_range<size_t>& range) {
        std::vector<uint32_t> others;
        for (size_t vertex = range.begin(); vertex < range.end(); ++vertex) {
          others.clear();
          for (const uint32_t corner : rings.corners[vertex]) {
            others.push_back(ToVertex(facets, corner));
            others.push_back(FromVertex(facets, PreviousHalfEdge(corner)));
          }
          std::ranges::sort(others);
          function(vertex, others);
        }
      });
}

// The number of different neighbors. One that is there only once is across an
// edge with one facet.
// \param others  ascending
uint64_t CountNeighbors(const std::vector<uint32_t>& others,
                        uint8_t* is_border) {
  uint64_t count = 0;
  for (auto first = others.begin(); first != others.end(); ++count) {
    const auto last = std::upper_bound(first, others.end(), *first);
    *is_border |= last - first == 1;
    first = last;
  }
  return count;
}

void FillNeighbors(const std::vector<Facet>& facets, VertexRings* rings) {
  std::vector<uint64_t>& offsets = rings->neighbors.offsets;
  offsets.assign(rings->NumVertices() + 1, 0);
  ForEachVertex(
      facets, *rings, [&](size_t vertex, const std::vector<uint32_t>& others) {
        offsets[vertex + 1] = CountNeighbors(others, &rings->is_border[vertex]);
      });
  std::inclusive_scan(offsets.begin(), offsets.end(), offsets.begin());
  rings->neighbors.values.resize(offsets.back());
  ForEachVertex(
      facets, *rings, [&](size_t vertex, const std::vector<uint32_t>& others) {
        std::unique_copy(others.begin(), others.end(),
                         rings->neighbors.values.data() + offsets[vertex]);
      });
}

}  // namespace

std::vector<uint32_t> VertexRings::FacetsAt(
    const std::vector<uint32_t>& vertices) const {
  std::vector<uint32_t> facets;
  for (const uint32_t vertex : vertices) {
    for (const uint32_t corner : corners[vertex]) {
      facets.push_back(corner / 3);
    }
  }
  SortUnique(&facets);
  return facets;
}

std::vector<uint32_t> VertexRings::VerticesAround(
    std::vector<uint32_t> vertices, int num_rings) const {
  SortUnique(&vertices);
  for (int ring = 0; ring < num_rings; ++ring) {
    for (size_t i = 0, size = vertices.size(); i < size; ++i) {
      Append(neighbors[vertices[i]], &vertices);
    }
    SortUnique(&vertices);
  }
  return vertices;
}

void AverageOverNeighbors(const Rows<uint32_t>& neighbors, int num_rounds,
                          std::vector<double>* values) {
  std::vector<double> means(values->size());
  for (int round = 0; round < num_rounds; ++round) {
    tbb::parallel_for(size_t{0}, values->size(), [&](size_t i) {
      const auto ring = neighbors[i];
      double sum = (*values)[i];
      for (const uint32_t neighbor : ring) {
        sum += (*values)[neighbor];
      }
      means[i] = sum / static_cast<double>(1 + ring.size());
    });
    values->swap(means);
  }
}

std::vector<uint32_t> VerticesOf(const TriangleMesh& mesh,
                                 const std::vector<uint32_t>& facets) {
  std::vector<uint32_t> vertices;
  for (const uint32_t facet : facets) {
    Append(mesh.facets[facet], &vertices);
  }
  SortUnique(&vertices);
  return vertices;
}

VertexRings MakeVertexRings(const TriangleMesh& mesh) {
  VertexRings rings;
  rings.is_border.assign(mesh.vertices.size(), 0);
  rings.corners = CornersByVertex(mesh.facets);
  rings.corners.offsets.resize(mesh.vertices.size() + 1,
                               rings.corners.values.size());
  FillNeighbors(mesh.facets, &rings);
  return rings;
}

}  // namespace colmap_ext
