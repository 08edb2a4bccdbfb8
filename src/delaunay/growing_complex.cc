#include "delaunay/growing_complex.h"

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <utility>

#include <tbb/parallel_for.h>

#include "base/rows.h"
#include "spatial/predicates.h"

namespace colmap_ext {
namespace {

// The first points in their order that span a volume, positively oriented;
// nothing if they lie in a plane.
std::optional<std::array<uint32_t, 4>> FindSimplex(
    std::span<const uint32_t> order,
    const std::vector<Eigen::Vector3f>& points) {
  if (order.size() < 4) {
    return std::nullopt;
  }
  const uint32_t a = order[0];
  const uint32_t b = order[1];
  size_t i = 2;
  while (i < order.size() &&
         AreCollinear(points[a], points[b], points[order[i]])) {
    ++i;
  }
  for (size_t k = i + 1; k < order.size(); ++k) {
    const uint32_t c = order[i];
    const uint32_t d = order[k];
    const int side = Orientation(points[a], points[b], points[c], points[d]);
    if (side != 0) {
      return side > 0 ? std::array{a, b, c, d} : std::array{b, a, c, d};
    }
  }
  return std::nullopt;
}

// The cells in use in their order: first by their lowest vertex, as a counting
// sort, then those of each vertex by the others.
// \pre the corners of each cell are sorted, cells not in use have equal ones
std::vector<uint32_t> Order(const std::vector<GrowingComplex::Cell>& cells,
                            size_t num_vertices) {
  auto rows = NumbersInRows(num_vertices, cells.size(), [&](uint32_t cell) {
    const std::array<uint32_t, 4>& vertices = cells[cell].vertices;
    return vertices[0] != vertices[1] ? vertices[0] : kNone;
  });
  tbb::parallel_for(size_t{0}, num_vertices, [&](size_t vertex) {
    std::ranges::sort(
        rows[vertex],
        {}, [&](uint32_t cell) -> const auto& { return cells[cell].vertices; });
  });
  return std::move(rows.values);
}

// The cells of a complex in an order that depends on their vertices alone, the
// corners of each sorted so that the first two vertices are the lowest. The
// complex has no cells afterwards.
std::vector<Tetrahedralization::Cell> TakeSortedCells(GrowingComplex* complex) {
  std::vector<GrowingComplex::Cell>& cells = complex->cells;
  tbb::parallel_for(size_t{0}, cells.size(), [&](size_t i) {
    SortCorners(&cells[i].vertices, &cells[i].mirror_facets);
  });
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
  tbb::parallel_for(size_t{0}, tetrahedra.cells.size(), [&](size_t i) {
    const auto cell = static_cast<uint32_t>(i);
    if (tetrahedra.IsInfinite(cell)) {
      return;
    }
    for (const uint32_t vertex : tetrahedra.cells[cell].vertices) {
      const std::atomic_ref least(first[vertex]);
      uint32_t before = least.load(std::memory_order_relaxed);
      while (cell < before && !least.compare_exchange_weak(before, cell)) {
      }
    }
  });
  return first;
}

}  // namespace

void AddFreeCells(size_t num_cells, GrowingComplex* complex) {
  const size_t begin = complex->cells.size();
  if (begin + num_cells >= UINT32_MAX / 4) {
    throw std::invalid_argument(
        "too many points for 32-bit indices: raise max_proj_dist");
  }
  complex->cells.resize(begin + num_cells);
  complex->locks.resize(begin + num_cells, GrowingComplex::kNotInUse);
  for (size_t i = begin + num_cells; i > begin; --i) {
    complex->free_cells.push_back(static_cast<uint32_t>(i - 1));
  }
}

bool SpansVolume(const std::vector<Eigen::Vector3f>& points) {
  return FindSimplex(Iota(points.size()), points).has_value();
}

std::array<uint32_t, 4> StartComplex(std::span<const uint32_t> order,
                                     GrowingComplex* complex) {
  const auto found = FindSimplex(order, complex->points);
  if (!found) {
    throw std::invalid_argument(
        "the points lie in a plane: there is no volume to mesh");
  }
  const std::array<uint32_t, 4>& simplex = *found;
  complex->vertex_cells.assign(complex->points.size(), kNone);
  std::vector<GrowingComplex::Cell>& cells = complex->cells;
  // The finite cell, and behind each of its facets i the infinite cell 1 + i,
  // which is the finite one mirrored.
  cells.resize(5);
  complex->locks.assign(cells.size(), GrowingComplex::kUnlocked);
  cells[0].vertices = simplex;
  for (uint32_t i = 0; i < 4; ++i) {
    cells[1 + i].vertices = simplex;
    cells[1 + i].vertices[i] = kInfiniteVertex;
    std::swap(cells[1 + i].vertices[(i + 1) % 4],
              cells[1 + i].vertices[(i + 2) % 4]);
    complex->vertex_cells[simplex[i]] = 0;
  }
  for (uint32_t i = 0; i < 4; ++i) {
    cells[0].mirror_facets[i] = 4 * (1 + i) + i;
    cells[1 + i].mirror_facets[i] = i;
    for (uint32_t k = 0; k < 4; ++k) {
      if (k != i) {
        cells[1 + i].mirror_facets[PlaceOf(simplex[k], cells[1 + i].vertices)] =
            4 * (1 + k) + PlaceOf(simplex[i], cells[1 + k].vertices);
      }
    }
  }
  return simplex;
}

uint32_t InfiniteCorner(const GrowingComplex::Cell& cell) {
  return static_cast<uint32_t>(
      std::ranges::find(cell.vertices, kInfiniteVertex) -
      cell.vertices.begin());
}

int OrientationWith(const GrowingComplex& complex,
                    const GrowingComplex::Cell& cell, uint32_t i,
                    const Eigen::Vector3f& point) {
  const auto corner = [&](uint32_t k) -> const Eigen::Vector3f& {
    return k == i ? point : complex.points[cell.vertices[k]];
  };
  return Orientation(corner(0), corner(1), corner(2), corner(3));
}

bool IsInConflict(const GrowingComplex& complex, uint32_t index,
                  const Eigen::Vector3f& point) {
  const GrowingComplex::Cell& cell = complex.cells[index];
  const auto corner = [&](uint32_t i) -> const Eigen::Vector3f& {
    return complex.points[cell.vertices[i]];
  };
  const uint32_t infinite = InfiniteCorner(cell);
  if (infinite == 4) {
    return IsInSphere(corner(0), corner(1), corner(2), corner(3), point);
  }
  const int side = OrientationWith(complex, cell, infinite, point);
  return side != 0 ? side > 0
                   : IsInCircle(corner((infinite + 1) % 4),
                                corner((infinite + 2) % 4),
                                corner((infinite + 3) % 4), point);
}

Tetrahedralization TakeTetrahedra(const std::vector<uint32_t>& numbers,
                                  GrowingComplex* complex) {
  for (const uint32_t cell : complex->free_cells) {
    complex->cells[cell].vertices.fill(0);  // may hold anything
  }
  tbb::parallel_for(size_t{0}, complex->cells.size(), [&](size_t i) {
    for (uint32_t& vertex : complex->cells[i].vertices) {
      if (vertex != kInfiniteVertex) {
        vertex = numbers[vertex];
      }
    }
  });
  // The sorting needs most memory.
  std::vector<uint16_t>().swap(complex->locks);
  std::vector<uint32_t>().swap(complex->vertex_cells);
  Tetrahedralization tetrahedra;
  tetrahedra.cells = TakeSortedCells(complex);
  tetrahedra.points.resize(numbers.size());
  for (size_t i = 0; i < numbers.size(); ++i) {
    tetrahedra.points[numbers[i]] = complex->points[i];
  }
  tetrahedra.vertex_cells = FirstCells(tetrahedra);
  *complex = {};
  return tetrahedra;
}

}  // namespace colmap_ext
