#include "delaunay/cell_conflict.h"

#include "delaunay/predicates.h"

namespace colmap_ext {

uint32_t InfiniteCorner(const GrowingComplex::Cell& cell) {
  uint32_t corner = 0;
  while (corner < 4 && cell.vertices[corner] != kInfiniteVertex) {
    ++corner;
  }
  return corner;
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

}  // namespace colmap_ext
