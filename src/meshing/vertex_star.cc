#include "meshing/vertex_star.h"

#include <algorithm>

namespace colmap_ext {
namespace {

// Calls visit(places) with the places in graph.cells of each component, in the
// order of VertexStar.
template <typename Visit>
void ForEachComponent(const StarGraph& graph,
                      const std::vector<uint8_t>& is_free, const Visit& visit) {
  thread_local std::vector<uint8_t> is_visited;
  thread_local std::vector<uint32_t> places;
  is_visited.assign(graph.cells.size(), 0);
  for (uint32_t seed = 0; seed < graph.cells.size(); ++seed) {
    if (is_visited[seed]) {
      continue;
    }
    const uint8_t label = is_free[graph.cells[seed]];
    is_visited[seed] = 1;
    places.assign(1, seed);
    for (size_t i = 0; i < places.size(); ++i) {
      for (const uint32_t neighbor : graph.neighbors[places[i]]) {
        if (!is_visited[neighbor] && is_free[graph.cells[neighbor]] == label) {
          is_visited[neighbor] = 1;
          places.push_back(neighbor);
        }
      }
    }
    visit(places);
  }
}

}  // namespace

void MakeVertexStar(const Tetrahedralization& tetrahedra,
                    const std::vector<uint8_t>& is_free, uint32_t vertex,
                    VertexStar* star) {
  thread_local StarGraph graph;
  MakeStarGraph(tetrahedra, vertex, &graph);
  star->cells.clear();
  star->offsets.assign(1, 0);
  star->is_free.clear();
  ForEachComponent(graph, is_free, [&](const std::vector<uint32_t>& places) {
    for (const uint32_t place : places) {
      star->cells.push_back(graph.cells[place]);
    }
    star->offsets.push_back(star->cells.size());
    star->is_free.push_back(is_free[star->cells.back()]);
  });
}

void MakeStarGraph(const Tetrahedralization& tetrahedra, uint32_t vertex,
                   StarGraph* graph) {
  std::vector<uint32_t>& cells = graph->cells;
  IncidentCells(tetrahedra, vertex, &cells);
  std::sort(cells.begin(), cells.end());
  graph->neighbors.resize(cells.size());
  for (size_t i = 0; i < cells.size(); ++i) {
    const Tetrahedralization::Cell& cell = tetrahedra.cells[cells[i]];
    int num_neighbors = 0;
    for (int k = 0; k < 4; ++k) {
      if (cell.vertices[k] != vertex) {
        graph->neighbors[i][num_neighbors++] = static_cast<uint32_t>(
            std::lower_bound(cells.begin(), cells.end(), cell.neighbors[k]) -
            cells.begin());
      }
    }
  }
}

size_t CountComponents(const StarGraph& graph,
                       const std::vector<uint8_t>& is_free) {
  size_t count = 0;
  ForEachComponent(graph, is_free,
                   [&](const std::vector<uint32_t>&) { ++count; });
  return count;
}

}  // namespace colmap_ext
