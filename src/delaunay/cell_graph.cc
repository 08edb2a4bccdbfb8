#include "delaunay/cell_graph.h"

namespace colmap_ext {

FlowGraph EmptyGraph(const Tetrahedralization& tetrahedra) {
  FlowGraph graph;
  const size_t num_cells = tetrahedra.cells.size();
  const size_t capacity = WithSpareCells(num_cells);
  graph.neighbors.reserve(capacity);
  graph.capacities.reserve(capacity);
  graph.source.reserve(capacity);
  graph.sink.reserve(capacity);
  for (const auto& cell : tetrahedra.cells) {
    graph.neighbors.push_back(cell.neighbors);
  }
  graph.capacities.resize(num_cells, {0, 0, 0, 0});
  graph.source.resize(num_cells, 0);
  graph.sink.resize(num_cells, 0);
  return graph;
}

}  // namespace colmap_ext
