#include "delaunay/cell_order.h"

#include <cstdint>
#include <numeric>
#include <utility>

#include <tbb/parallel_sort.h>

namespace colmap_ext {

void SortCorners(Tetrahedralization::Cell* cell) {
  bool odd = false;
  for (int i = 1; i < 4; ++i) {
    for (int j = i; j > 0 && cell->vertices[j] < cell->vertices[j - 1]; --j) {
      std::swap(cell->vertices[j], cell->vertices[j - 1]);
      std::swap(cell->neighbors[j], cell->neighbors[j - 1]);
      odd = !odd;
    }
  }
  if (odd) {
    std::swap(cell->vertices[2], cell->vertices[3]);
    std::swap(cell->neighbors[2], cell->neighbors[3]);
  }
}

void SortCells(std::vector<Tetrahedralization::Cell>* cells) {
  std::vector<uint32_t> order(cells->size());
  std::iota(order.begin(), order.end(), 0);
  tbb::parallel_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
    return (*cells)[a].vertices < (*cells)[b].vertices;
  });
  std::vector<uint32_t> rank(cells->size());
  for (uint32_t i = 0; i < order.size(); ++i) {
    rank[order[i]] = i;
  }
  std::vector<Tetrahedralization::Cell> sorted;
  sorted.reserve(WithSpareCells(cells->size()));
  sorted.resize(cells->size());
  for (size_t i = 0; i < order.size(); ++i) {
    sorted[i] = (*cells)[order[i]];
    for (uint32_t& neighbor : sorted[i].neighbors) {
      neighbor = rank[neighbor];
    }
  }
  cells->swap(sorted);
}

}  // namespace colmap_ext
