#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <queue>
#include <utility>
#include <vector>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "base/indices.h"
#include "base/rows.h"
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

// The corners at each vertex, ascending, up to the last vertex that facets use.
// A corner is named by the half-edge that leaves it.
// \throw std::invalid_argument if there are more half-edges than 32-bit indices
//        can number.
Rows<uint32_t> CornersByVertex(const std::vector<Facet>& facets);

// The half-edge before this one in its facet.
inline uint32_t PreviousHalfEdge(uint32_t half) {
  return half % 3 == 0 ? half + 2 : half - 1;
}

// Another vertex, and a half-edge between it and one vertex.
using HalfEdgeTo = std::pair<uint32_t, uint32_t>;

// Calls function(vertex, half_edges) for each vertex up to the last that facets
// use: its half-edges, leaving and entering, by the other vertex, then by their
// number.
// \tparam kInParallel  else for one vertex after the other
// \pre no facet repeats a vertex
// \throw std::invalid_argument as CornersByVertex() does.
template <bool kInParallel = false, typename Function>
void ForEachVertex(const std::vector<Facet>& facets, const Function& function) {
  const Rows<uint32_t> corners = CornersByVertex(facets);
  const auto visit = [&](const tbb::blocked_range<uint32_t>& vertices) {
    std::vector<HalfEdgeTo> halves;
    for (uint32_t vertex = vertices.begin(); vertex < vertices.end();
         ++vertex) {
      halves.clear();
      for (const uint32_t corner : corners[vertex]) {
        const uint32_t before = PreviousHalfEdge(corner);
        halves.emplace_back(ToVertex(facets, corner), corner);
        halves.emplace_back(FromVertex(facets, before), before);
      }
      std::ranges::sort(halves);
      function(vertex, halves);
    }
  };
  constexpr size_t kGrain = 1024;  // vertices a task; a choice
  const tbb::blocked_range<uint32_t> all(
      0, static_cast<uint32_t>(corners.size()), kGrain);
  if constexpr (kInParallel) {
    tbb::parallel_for(all, visit);
  } else {
    visit(all);
  }
}

// Calls function(first, last) for the half-edges to each other vertex.
template <typename Function>
void ForEachNeighbor(const std::vector<HalfEdgeTo>& halves,
                     const Function& function) {
  for (auto first = halves.begin(); first != halves.end();) {
    auto last = first;
    while (last != halves.end() && last->first == first->first) {
      ++last;
    }
    function(first, last);
    first = last;
  }
}

// Calls function(first, last) for each edge, in the order of its lower, then of
// its higher vertex: it->second of the iterators are its half-edges, ascending.
// \pre as above
template <bool kInParallel = false, typename Function>
void ForEachEdge(const std::vector<Facet>& facets, const Function& function) {
  ForEachVertex<kInParallel>(
      facets, [&](uint32_t vertex, const std::vector<HalfEdgeTo>& halves) {
        ForEachNeighbor(halves, [&](auto first, auto last) {
          if (first->first > vertex) {
            function(first, last);
          }
        });
      });
}

// Returns [3 F] the partner of each half-edge: the other one of its edge, where
// exactly two facets share the edge and run it in opposite directions; else
// kNone.
std::vector<uint32_t> PairHalfEdges(const std::vector<Facet>& facets);

// The neighbors and facets of each vertex.
struct VertexRings {
  Rows<uint32_t> neighbors;  // [V] the vertices that share an edge with it,
                             // ascending
  Rows<uint32_t> corners;    // [V] the corners at it, ascending; corner
                             // 3 * facet + k is corner k of the facet
  std::vector<uint8_t> is_border;  // [V] whether it is an end of an edge with
                                   // one facet

  size_t NumVertices() const { return is_border.size(); }
  bool operator==(const VertexRings&) const = default;

  // The facets at some vertices, ascending.
  std::vector<uint32_t> FacetsAt(const std::vector<uint32_t>& vertices) const;

  // Some vertices and those in a number of rings of edges around them,
  // ascending.
  std::vector<uint32_t> VerticesAround(std::vector<uint32_t> vertices,
                                       int num_rings) const;
};

// Diffusion on a mesh: so many times in turn each vertex's value becomes the
// mean of the vertex and its neighbors.
// \param neighbors [V]
// \param values [V]
void AverageOverNeighbors(const Rows<uint32_t>& neighbors, int num_rounds,
                          std::vector<double>* values);

// The vertices of some facets, ascending.
std::vector<uint32_t> VerticesOf(const TriangleMesh& mesh,
                                 const std::vector<uint32_t>& facets);

// The rows of vertices that no facet uses are empty.
// \pre facet indices are in range, no facet repeats a vertex
VertexRings MakeVertexRings(const TriangleMesh& mesh);

// The neighbors that a vertex is smoothed by, ascending: all, but at the border
// only those along it.
// \param rings  MakeVertexRings(mesh)
std::vector<uint32_t> SmoothingNeighbors(const TriangleMesh& mesh,
                                         const VertexRings& rings,
                                         uint32_t vertex);

// [V] The mean distance of each vertex from its neighbors, scene units; 0 where
// it has none.
std::vector<double> MeanLengths(const Rows<uint32_t>& neighbors,
                                const std::vector<Eigen::Vector3f>& vertices);

// Lowers the values of vertices so that none exceeds the value of a neighbor
// plus the cost of the edge from there [Dijkstra1959].
// \param max  larger values are neither handed on nor assigned
// \param cost  cost(from, to) of an edge, not negative
// \param values [V] may be infinite
template <typename Cost>
void LowerAlongEdges(const VertexRings& rings, float max, const Cost& cost,
                     std::vector<float>* values) {
  using Reached = std::pair<float, uint32_t>;
  std::priority_queue<Reached, std::vector<Reached>, std::greater<>> queue;
  // Only vertices that lower a neighbor start: they are few.
  std::vector<uint8_t> lowers(values->size());
  tbb::parallel_for(size_t{0}, lowers.size(), [&](size_t i) {
    for (const uint32_t neighbor : rings.neighbors[i]) {
      const float reached =
          (*values)[i] + cost(static_cast<uint32_t>(i), neighbor);
      lowers[i] |= reached <= max && reached < (*values)[neighbor] ? 1 : 0;
    }
  });
  for (const uint32_t vertex : Marked(lowers)) {
    queue.emplace((*values)[vertex], vertex);
  }
  while (!queue.empty()) {
    const auto [value, vertex] = queue.top();
    queue.pop();
    if (value > (*values)[vertex]) {
      continue;
    }
    for (const uint32_t neighbor : rings.neighbors[vertex]) {
      const float reached = value + cost(vertex, neighbor);
      if (reached <= max && reached < (*values)[neighbor]) {
        (*values)[neighbor] = reached;
        queue.emplace(reached, neighbor);
      }
    }
  }
}

}  // namespace colmap_ext
