#include "delaunay/cell_graph.h"

#include <algorithm>
#include <atomic>

namespace colmap_ext {

NeighborView NeighborsOf(const Tetrahedralization& tetrahedra) {
  return {&tetrahedra.cells.data()->neighbors,
          sizeof(Tetrahedralization::Cell)};
}

FlowCapacities ZeroCapacities(const Tetrahedralization& tetrahedra) {
  FlowCapacities graph;
  const size_t num_cells = tetrahedra.cells.size();
  const size_t capacity = WithSpareCells(num_cells);
  graph.capacities.reserve(capacity);
  graph.source.reserve(capacity);
  graph.sink.reserve(capacity);
  graph.capacities.resize(num_cells, {0, 0, 0, 0});
  graph.source.resize(num_cells, 0);
  graph.sink.resize(num_cells, 0);
  return graph;
}

uint32_t ToCapacity(double weight) {
  return static_cast<uint32_t>(
      std::min<double>(kWeightUnit * weight + 0.5, kMaxCapacity));
}

void AddCapacity(uint32_t capacity, uint32_t* sum) {
  std::atomic_ref<uint32_t> atomic(*sum);
  if (atomic.load(std::memory_order_relaxed) <= kMaxCapacity) {
    atomic.fetch_add(capacity, std::memory_order_relaxed);
  }
}

}  // namespace colmap_ext
