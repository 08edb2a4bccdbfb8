#include "delaunay/locate.h"

#include <utility>

#include "delaunay/predicates.h"

namespace colmap_ext {

uint32_t Locate(const Tetrahedralization& tetrahedra,
                const Eigen::Vector3d& point, uint32_t hint) {
  uint32_t cell_index = hint;
  uint32_t previous = kNone;
  while (!tetrahedra.IsInfinite(cell_index)) {
    const Tetrahedralization::Cell& cell = tetrahedra.cells[cell_index];
    uint32_t next = kNone;
    for (int i = 0; i < 4 && next == kNone; ++i) {
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
    if (next == kNone) {
      break;
    }
    previous = std::exchange(cell_index, next);
  }
  return cell_index;
}

uint32_t EnteredCell(const Tetrahedralization& tetrahedra, uint32_t cell_index,
                     const Eigen::Vector3d& origin,
                     const Eigen::Vector3d& target) {
  for (int i = 0; i < 4 && !tetrahedra.IsInfinite(cell_index);) {
    const Tetrahedralization::Cell& cell = tetrahedra.cells[cell_index];
    const auto corner = [&](int k) -> Eigen::Vector3d {
      return tetrahedra.points[cell.vertices[kFacetCorners[i][k]]]
          .cast<double>();
    };
    const bool leaves =
        Orientation(corner(0), corner(1), corner(2), origin) == 0 &&
        RaySideExact(corner(0), target, corner(1), corner(2)) < 0;
    if (leaves) {
      cell_index = cell.neighbors[i];
    }
    i = leaves ? 0 : i + 1;
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
