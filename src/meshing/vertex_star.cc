#include "meshing/vertex_star.h"

#include <algorithm>
#include <numeric>

#include "delaunay/cell_places.h"

namespace colmap_ext {
namespace {

// Calls visit(places) with the places in graph.cells of each component.
// \param seed_at  [S] -> all places: in this order components are found
template <typename SeedAt, typename Visit>
void ForEachComponent(const StarGraph& graph, const CellLabels& labels,
                      const SeedAt& seed_at, const Visit& visit) {
  thread_local std::vector<uint8_t> is_visited;
  thread_local std::vector<uint32_t> places;
  is_visited.assign(graph.cells.size(), 0);
  for (uint32_t k = 0; k < graph.cells.size(); ++k) {
    const uint32_t seed = seed_at(k);
    if (is_visited[seed]) {
      continue;
    }
    const uint8_t label = labels[graph.cells[seed]];
    is_visited[seed] = 1;
    places.assign(1, seed);
    for (size_t i = 0; i < places.size(); ++i) {
      for (const uint32_t neighbor : graph.neighbors[places[i]]) {
        if (!is_visited[neighbor] && labels[graph.cells[neighbor]] == label) {
          is_visited[neighbor] = 1;
          places.push_back(neighbor);
        }
      }
    }
    visit(places);
  }
}

}  // namespace

CellLabels::CellLabels(const std::vector<uint8_t>& is_free,
                       std::span<const uint32_t> flipped)
    : is_free_(is_free), flipped_(flipped) {
  for (const uint32_t cell : flipped) {
    residues_ |= uint64_t{1} << (cell % 64);
  }
}

bool CellLabels::IsFlipped(uint32_t cell) const {
  return std::ranges::binary_search(flipped_, cell);
}

void MakeStarGraph(const Tetrahedralization& tetrahedra, uint32_t vertex,
                   StarGraph* graph) {
  thread_local CellPlaces places;
  places.Clear();
  graph->cells.clear();
  graph->neighbors.clear();
  places.PlaceIn(tetrahedra.vertex_cells[vertex], &graph->cells);
  for (size_t i = 0; i < graph->cells.size(); ++i) {
    const Tetrahedralization::Cell& cell = tetrahedra.cells[graph->cells[i]];
    std::array<uint32_t, 3>& neighbors = graph->neighbors.emplace_back();
    int num_neighbors = 0;
    for (int k = 0; k < 4; ++k) {
      if (cell.vertices[k] != vertex) {
        neighbors[num_neighbors++] =
            places.PlaceIn(cell.neighbors[k], &graph->cells);
      }
    }
  }
}

void MakeVertexStar(const StarGraph& graph, const CellLabels& labels,
                    VertexStar* star) {
  std::vector<uint32_t> seeds(graph.cells.size());
  std::iota(seeds.begin(), seeds.end(), 0);
  std::ranges::sort(seeds, {}, [&](uint32_t i) { return graph.cells[i]; });
  star->cells.clear();
  star->offsets.assign(1, 0);
  star->is_free.clear();
  ForEachComponent(
      graph, labels, [&](uint32_t k) { return seeds[k]; },
      [&](const std::vector<uint32_t>& places) {
        for (const uint32_t place : places) {
          star->cells.push_back(graph.cells[place]);
        }
        star->offsets.push_back(star->cells.size());
        star->is_free.push_back(labels[star->cells.back()]);
      });
}

void MakeVertexStar(const Tetrahedralization& tetrahedra,
                    const std::vector<uint8_t>& is_free, uint32_t vertex,
                    VertexStar* star) {
  thread_local StarGraph graph;
  MakeStarGraph(tetrahedra, vertex, &graph);
  MakeVertexStar(graph, CellLabels(is_free), star);
}

size_t CountComponents(const StarGraph& graph, const CellLabels& labels) {
  size_t count = 0;
  ForEachComponent(
      graph, labels, [](uint32_t k) { return k; },
      [&](const std::vector<uint32_t>&) { ++count; });
  return count;
}

}  // namespace colmap_ext
