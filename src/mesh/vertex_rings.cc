#include "mesh/vertex_rings.h"

#include <algorithm>
#include <atomic>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace colmap_ext {
namespace {

// Turns [V + 1] numbers, of row v at v + 1, into offsets.
void AddUp(std::vector<uint64_t>* offsets) {
  for (size_t i = 1; i < offsets->size(); ++i) {
    (*offsets)[i] += (*offsets)[i - 1];
  }
}

// The rows are filled in any order, then sorted.
void FillCorners(const std::vector<Facet>& facets, VertexRings* rings) {
  const size_t num_vertices = rings->NumVertices();
  const auto num_corners = static_cast<uint32_t>(3 * facets.size());
  const auto vertex_at = [&](uint32_t corner) {
    return facets[corner / 3][corner % 3];
  };
  std::vector<std::atomic<uint32_t>> counts(num_vertices);
  tbb::parallel_for(uint32_t{0}, num_corners, [&](uint32_t corner) {
    counts[vertex_at(corner)].fetch_add(1, std::memory_order_relaxed);
  });
  rings->corners.offsets.assign(num_vertices + 1, 0);
  for (size_t vertex = 0; vertex < num_vertices; ++vertex) {
    rings->corners.offsets[vertex + 1] = counts[vertex];
  }
  AddUp(&rings->corners.offsets);
  rings->corners.values.resize(num_corners);
  tbb::parallel_for(uint32_t{0}, num_corners, [&](uint32_t corner) {
    const uint32_t vertex = vertex_at(corner);
    const uint32_t left =
        counts[vertex].fetch_sub(1, std::memory_order_relaxed);
    rings->corners.values[rings->corners.offsets[vertex] + left - 1] = corner;
  });
  tbb::parallel_for(size_t{0}, num_vertices, [&](size_t vertex) {
    std::sort(
        rings->corners.values.data() + rings->corners.offsets[vertex],
        rings->corners.values.data() + rings->corners.offsets[vertex + 1]);
  });
}

// The other vertices of the facets at a vertex, ascending, once for each facet.
void CollectNeighbors(const std::vector<Facet>& facets,
                      std::span<const uint32_t> corners,
                      std::vector<uint32_t>* others) {
  others->clear();
  for (const uint32_t corner : corners) {
    const Facet& facet = facets[corner / 3];
    others->push_back(facet[(corner + 1) % 3]);
    others->push_back(facet[(corner + 2) % 3]);
  }
  std::sort(others->begin(), others->end());
}

// Calls function(vertex, others) for each vertex, in parallel.
template <typename Function>
void ForEachVertex(const std::vector<Facet>& facets, const VertexRings& rings,
                   const Function& function) {
  constexpr size_t kGrain = 1024;  // vertices a task; a choice
  tbb::parallel_for(
      tbb::blocked_range<size_t>(0, rings.NumVertices(), kGrain),
      [&](const tbb::blocked_range<size_t>& range) {
        std::vector<uint32_t> others;
        for (size_t vertex = range.begin(); vertex < range.end(); ++vertex) {
          CollectNeighbors(facets, rings.corners[vertex], &others);
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
  AddUp(&offsets);
  rings->neighbors.values.resize(offsets.back());
  ForEachVertex(
      facets, *rings, [&](size_t vertex, const std::vector<uint32_t>& others) {
        std::unique_copy(others.begin(), others.end(),
                         rings->neighbors.values.data() + offsets[vertex]);
      });
}

}  // namespace

VertexRings MakeVertexRings(const TriangleMesh& mesh) {
  VertexRings rings;
  rings.is_border.assign(mesh.vertices.size(), 0);
  FillCorners(mesh.facets, &rings);
  FillNeighbors(mesh.facets, &rings);
  return rings;
}

}  // namespace colmap_ext
