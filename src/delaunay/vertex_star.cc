#include "delaunay/vertex_star.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <span>
#include <utility>

#include <tbb/parallel_for.h>

namespace colmap_ext {
namespace {

using Facet = std::array<uint32_t, 3>;

// An edge of a vertex's link, the sphere of the facets opposite to it in its
// cells, where free space and matter meet; run with matter on the same side.
using LinkEdge = std::pair<uint32_t, uint32_t>;

// All facets between matter and free space, those at infinity, too.
std::vector<Facet> BoundaryFacets(const Tetrahedralization& tetrahedra,
                                  const std::vector<uint8_t>& is_free) {
  std::vector<Facet> facets;
  for (size_t index = 0; index < tetrahedra.cells.size(); ++index) {
    const auto& cell = tetrahedra.cells[index];
    for (int i = 0; i < 4 && !is_free[index]; ++i) {
      if (is_free[cell.neighbors[i]]) {
        const auto& corners = kFacetCorners[i];
        facets.push_back({cell.vertices[corners[0]], cell.vertices[corners[1]],
                          cell.vertices[corners[2]]});
      }
    }
  }
  return facets;
}

// Whether the edges form one simple cycle, or are none at all. A planar graph
// whose vertices all have as many edges in as out divides the sphere into two
// regions just then, so that this is VertexStar::IsSingular the other way
// about.
bool IsAtMostOneCycle(std::span<LinkEdge> edges) {
  if (edges.empty()) {
    return true;
  }
  std::sort(edges.begin(), edges.end());
  size_t length = 0;
  uint32_t at = edges.front().first;
  do {
    const auto edge =
        std::lower_bound(edges.begin(), edges.end(), LinkEdge{at, 0});
    if (edge + 1 != edges.end() && (edge + 1)->first == at) {
      return false;
    }
    at = edge->second;
    ++length;
  } while (at != edges.front().first);
  return length == edges.size();
}

}  // namespace

void MakeVertexStar(const Tetrahedralization& tetrahedra,
                    const std::vector<uint8_t>& is_free, uint32_t vertex,
                    VertexStar* star) {
  thread_local std::vector<uint32_t> cells;
  thread_local std::vector<uint8_t> is_visited;
  IncidentCells(tetrahedra, vertex, &cells);
  std::sort(cells.begin(), cells.end());
  is_visited.assign(cells.size(), 0);
  star->components.clear();
  for (size_t seed = 0; seed < cells.size(); ++seed) {
    if (is_visited[seed]) {
      continue;
    }
    is_visited[seed] = 1;
    VertexStar::Component& component = star->components.emplace_back();
    component.is_free = is_free[cells[seed]] != 0;
    component.cells.push_back(cells[seed]);
    for (size_t i = 0; i < component.cells.size(); ++i) {
      const auto& cell = tetrahedra.cells[component.cells[i]];
      for (int k = 0; k < 4; ++k) {
        const uint32_t neighbor = cell.neighbors[k];
        if (cell.vertices[k] == vertex ||
            (is_free[neighbor] != 0) != component.is_free) {
          continue;
        }
        const auto index =
            std::lower_bound(cells.begin(), cells.end(), neighbor) -
            cells.begin();
        if (!is_visited[index]) {
          is_visited[index] = 1;
          component.cells.push_back(neighbor);
        }
      }
    }
  }
}

bool IsSingular(const Tetrahedralization& tetrahedra,
                const std::vector<uint8_t>& is_free, uint32_t vertex) {
  thread_local VertexStar star;
  MakeVertexStar(tetrahedra, is_free, vertex, &star);
  return star.IsSingular();
}

std::vector<uint32_t> SingularVertices(const Tetrahedralization& tetrahedra,
                                       const std::vector<uint8_t>& is_free) {
  const std::vector<Facet> facets = BoundaryFacets(tetrahedra, is_free);
  // The boundary facets' corners around each vertex, compressed sparse rows.
  std::vector<uint32_t> offsets(tetrahedra.points.size() + 1, 0);
  for (const Facet& facet : facets) {
    for (const uint32_t vertex : facet) {
      if (vertex != kInfiniteVertex) {
        ++offsets[vertex + 1];
      }
    }
  }
  std::partial_sum(offsets.begin(), offsets.end(), offsets.begin());
  std::vector<LinkEdge> edges(offsets.back());
  std::vector<uint32_t> next(offsets.begin(), offsets.end() - 1);
  for (const Facet& facet : facets) {
    for (int k = 0; k < 3; ++k) {
      if (facet[k] != kInfiniteVertex) {
        edges[next[facet[k]]++] = {facet[(k + 1) % 3], facet[(k + 2) % 3]};
      }
    }
  }
  std::vector<uint8_t> is_singular(tetrahedra.points.size(), 0);
  tbb::parallel_for(size_t{0}, is_singular.size(), [&](size_t vertex) {
    is_singular[vertex] = !IsAtMostOneCycle(
        {edges.data() + offsets[vertex], edges.data() + offsets[vertex + 1]});
  });
  std::vector<uint32_t> singular;
  for (uint32_t vertex = 0; vertex < is_singular.size(); ++vertex) {
    if (is_singular[vertex]) {
      singular.push_back(vertex);
    }
  }
  return singular;
}

}  // namespace colmap_ext
