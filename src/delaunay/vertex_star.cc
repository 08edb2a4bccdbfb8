#include "delaunay/vertex_star.h"

#include <algorithm>

#include <tbb/parallel_for.h>

namespace colmap_ext {

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
  // Only a vertex of a facet between the two labels can be singular.
  std::vector<uint8_t> is_on_boundary(tetrahedra.points.size(), 0);
  for (size_t index = 0; index < tetrahedra.cells.size(); ++index) {
    const auto& cell = tetrahedra.cells[index];
    for (int i = 0; i < 4; ++i) {
      if (is_free[index] && !is_free[cell.neighbors[i]]) {
        for (const int corner : kFacetCorners[i]) {
          if (cell.vertices[corner] != kInfiniteVertex) {
            is_on_boundary[cell.vertices[corner]] = 1;
          }
        }
      }
    }
  }
  std::vector<uint8_t> is_singular(tetrahedra.points.size(), 0);
  tbb::parallel_for(size_t{0}, is_singular.size(), [&](size_t vertex) {
    is_singular[vertex] =
        is_on_boundary[vertex] &&
        IsSingular(tetrahedra, is_free, static_cast<uint32_t>(vertex));
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
