#include "delaunay/vertex_star.h"

#include <algorithm>

namespace colmap_ext {
namespace {

// The cells around one vertex, and which of them belong to a component already.
struct Surroundings {
  std::vector<uint32_t> cells;  // ascending
  std::vector<uint8_t> is_visited;

  // \pre the cell is one of them
  bool Visit(uint32_t cell) {
    const auto index =
        std::lower_bound(cells.begin(), cells.end(), cell) - cells.begin();
    const bool is_new = !is_visited[index];
    is_visited[index] = 1;
    return is_new;
  }
};

// Appends a cell and all cells that are connected to it, breadth first.
void AppendComponent(const Tetrahedralization& tetrahedra,
                     const std::vector<uint8_t>& is_free, uint32_t vertex,
                     uint32_t seed, Surroundings* surroundings,
                     VertexStar* star) {
  std::vector<uint32_t>& cells = star->cells;
  cells.push_back(seed);
  for (size_t i = star->offsets.back(); i < cells.size(); ++i) {
    const Tetrahedralization::Cell& cell = tetrahedra.cells[cells[i]];
    for (int k = 0; k < 4; ++k) {
      const uint32_t neighbor = cell.neighbors[k];
      if (cell.vertices[k] != vertex && is_free[neighbor] == is_free[seed] &&
          surroundings->Visit(neighbor)) {
        cells.push_back(neighbor);
      }
    }
  }
  star->is_free.push_back(is_free[seed]);
  star->offsets.push_back(cells.size());
}

}  // namespace

void MakeVertexStar(const Tetrahedralization& tetrahedra,
                    const std::vector<uint8_t>& is_free, uint32_t vertex,
                    VertexStar* star) {
  thread_local Surroundings surroundings;
  IncidentCells(tetrahedra, vertex, &surroundings.cells);
  std::sort(surroundings.cells.begin(), surroundings.cells.end());
  surroundings.is_visited.assign(surroundings.cells.size(), 0);
  star->cells.clear();
  star->offsets.assign(1, 0);
  star->is_free.clear();
  for (size_t i = 0; i < surroundings.cells.size(); ++i) {
    if (!surroundings.is_visited[i]) {
      surroundings.is_visited[i] = 1;
      AppendComponent(tetrahedra, is_free, vertex, surroundings.cells[i],
                      &surroundings, star);
    }
  }
}

}  // namespace colmap_ext
