#include "delaunay/take_tetrahedra.h"

#include <algorithm>

#include <tbb/parallel_for.h>

#include "delaunay/cell_order.h"

namespace colmap_ext {

std::vector<uint32_t> FirstCells(const Tetrahedralization& tetrahedra) {
  std::vector<uint32_t> first(tetrahedra.points.size(), kNone);
  for (uint32_t cell = 0; cell < tetrahedra.cells.size(); ++cell) {
    if (tetrahedra.IsInfinite(cell)) {
      continue;
    }
    for (const uint32_t vertex : tetrahedra.cells[cell].vertices) {
      first[vertex] = std::min(first[vertex], cell);
    }
  }
  return first;
}

Tetrahedralization TakeTetrahedra(const std::vector<uint32_t>& numbers,
                                  GrowingComplex* complex) {
  tbb::parallel_for(size_t{0}, complex->cells.size(), [&](size_t i) {
    for (uint32_t& vertex : complex->cells[i].vertices) {
      if (vertex != kInfiniteVertex) {
        vertex = numbers[vertex];
      }
    }
  });
  Tetrahedralization tetrahedra;
  tetrahedra.points.resize(complex->points.size());
  for (size_t i = 0; i < numbers.size(); ++i) {
    tetrahedra.points[numbers[i]] = complex->points[i];
  }
  tetrahedra.cells = TakeSortedCells(complex);
  tetrahedra.vertex_cells = FirstCells(tetrahedra);
  *complex = {};
  return tetrahedra;
}

}  // namespace colmap_ext
