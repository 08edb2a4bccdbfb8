#include "delaunay/take_tetrahedra.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include <tbb/parallel_for.h>

namespace colmap_ext {
namespace {

// Sorts a cell's corners, and its mirror facets with them, so that the first
// two vertices are the lowest and the cell keeps its orientation.
void SortCorners(GrowingComplex::Cell* cell) {
  bool odd = false;
  for (int i = 1; i < 4; ++i) {
    for (int j = i; j > 0 && cell->vertices[j] < cell->vertices[j - 1]; --j) {
      std::swap(cell->vertices[j], cell->vertices[j - 1]);
      std::swap(cell->mirror_facets[j], cell->mirror_facets[j - 1]);
      odd = !odd;
    }
  }
  if (odd) {
    std::swap(cell->vertices[2], cell->vertices[3]);
    std::swap(cell->mirror_facets[2], cell->mirror_facets[3]);
  }
}

// The cells in use in their order: first by their lowest vertex, as a counting
// sort, then those of each vertex by the others.
// \pre the corners of each cell are sorted, cells not in use have equal ones
std::vector<uint32_t> Order(const std::vector<GrowingComplex::Cell>& cells,
                            size_t num_vertices) {
  const auto is_used = [&](uint32_t cell) {
    return cells[cell].vertices[0] != cells[cell].vertices[1];
  };
  const auto num_cells = static_cast<uint32_t>(cells.size());
  std::vector<uint32_t> begins(num_vertices + 1, 0);
  for (uint32_t cell = 0; cell < num_cells; ++cell) {
    begins[cells[cell].vertices[0] + 1] += is_used(cell);
  }
  std::partial_sum(begins.begin(), begins.end(), begins.begin());
  std::vector<uint32_t> order(begins.back());
  for (uint32_t cell = 0; cell < num_cells; ++cell) {
    if (is_used(cell)) {
      order[begins[cells[cell].vertices[0]]++] = cell;
    }
  }
  // Now a vertex's entry is its row's end.
  tbb::parallel_for(size_t{0}, num_vertices, [&](size_t vertex) {
    const uint32_t begin = vertex == 0 ? 0 : begins[vertex - 1];
    std::sort(order.begin() + begin, order.begin() + begins[vertex],
              [&](uint32_t a, uint32_t b) {
                return cells[a].vertices < cells[b].vertices;
              });
  });
  return order;
}

// The cells of a complex in an order that depends on their vertices alone, the
// corners of each sorted so that the first two vertices are the lowest. The
// complex has no cells afterwards.
std::vector<Tetrahedralization::Cell> TakeSortedCells(GrowingComplex* complex) {
  std::vector<GrowingComplex::Cell>& cells = complex->cells;
  for (const uint32_t cell : complex->free_cells) {
    cells[cell].vertices.fill(0);
  }
  tbb::parallel_for(size_t{0}, cells.size(),
                    [&](size_t i) { SortCorners(&cells[i]); });
  const std::vector<uint32_t> order = Order(cells, complex->points.size());
  std::vector<uint32_t> rank(cells.size());
  tbb::parallel_for(size_t{0}, order.size(), [&](size_t i) {
    rank[order[i]] = static_cast<uint32_t>(i);
  });
  std::vector<Tetrahedralization::Cell> sorted;
  sorted.reserve(WithSpareCells(order.size()));
  sorted.resize(order.size());
  tbb::parallel_for(size_t{0}, order.size(), [&](size_t i) {
    sorted[i].vertices = cells[order[i]].vertices;
    for (int k = 0; k < 4; ++k) {
      sorted[i].neighbors[k] = rank[cells[order[i]].mirror_facets[k] / 4];
    }
  });
  std::vector<GrowingComplex::Cell>().swap(cells);
  std::vector<uint32_t>().swap(complex->free_cells);
  return sorted;
}

// The first finite cell of each vertex.
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

}  // namespace

Tetrahedralization TakeTetrahedra(const std::vector<uint32_t>& numbers,
                                  GrowingComplex* complex) {
  tbb::parallel_for(size_t{0}, complex->cells.size(), [&](size_t i) {
    for (uint32_t& vertex : complex->cells[i].vertices) {
      if (vertex != kInfiniteVertex) {
        vertex = numbers[vertex];
      }
    }
  });
  // The sorting needs most memory.
  std::vector<uint8_t>().swap(complex->is_marked);
  std::vector<uint32_t>().swap(complex->vertex_cells);
  Tetrahedralization tetrahedra;
  tetrahedra.cells = TakeSortedCells(complex);
  tetrahedra.points.resize(
      numbers.size() - static_cast<size_t>(std::ranges::count(numbers, kNone)));
  for (size_t i = 0; i < numbers.size(); ++i) {
    if (numbers[i] != kNone) {
      tetrahedra.points[numbers[i]] = complex->points[i];
    }
  }
  tetrahedra.vertex_cells = FirstCells(tetrahedra);
  *complex = {};
  return tetrahedra;
}

}  // namespace colmap_ext
