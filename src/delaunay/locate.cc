#include "delaunay/locate.h"

#include <utility>

#include "delaunay/predicates.h"

namespace colmap_ext {

uint32_t Locate(const Tetrahedralization& tetrahedra,
                const Eigen::Vector3d& point, uint32_t hint) {
  uint32_t cell_index = hint;
  uint32_t previous = kNoCell;
  while (!tetrahedra.IsInfinite(cell_index)) {
    const Tetrahedralization::Cell& cell = tetrahedra.cells[cell_index];
    uint32_t next = kNoCell;
    for (int i = 0; i < 4 && next == kNoCell; ++i) {
      if (cell.neighbors[i] == previous) {
        continue;
      }
      const auto& corners = kFacetCorners[i];
      const auto corner = [&](int k) -> Eigen::Vector3d {
        return tetrahedra.points[cell.vertices[corners[k]]].cast<double>();
      };
      if (Orientation(corner(0), corner(1), corner(2), point) < 0) {
        next = cell.neighbors[i];
      }
    }
    if (next == kNoCell) {
      break;
    }
    previous = std::exchange(cell_index, next);
  }
  return cell_index;
}

bool IsStrictlyInside(const Tetrahedralization& tetrahedra, uint32_t cell_index,
                      const Eigen::Vector3d& point) {
  const Tetrahedralization::Cell& cell = tetrahedra.cells[cell_index];
  for (const auto& corners : kFacetCorners) {
    const auto corner = [&](int k) -> Eigen::Vector3d {
      return tetrahedra.points[cell.vertices[corners[k]]].cast<double>();
    };
    if (Orientation(corner(0), corner(1), corner(2), point) <= 0) {
      return false;
    }
  }
  return true;
}

}  // namespace colmap_ext
