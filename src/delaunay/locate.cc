#include "delaunay/ray_walk.h"

#include <array>
#include <utility>

#include "spatial/predicates.h"

namespace colmap_ext {
namespace {

using FacetPoints = std::array<Eigen::Vector3d, 3>;

// The corners of a cell's facet i, see kFacetCorners.
// \pre they are finite
FacetPoints PointsOfFacet(const Tetrahedralization& tetrahedra, uint32_t cell,
                          int i) {
  const auto [a, b, c] = FacetVertices(tetrahedra.cells[cell], i);
  return {tetrahedra.PositionOf(a), tetrahedra.PositionOf(b),
          tetrahedra.PositionOf(c)};
}

// Whether a point lies on a facet's inner side: 1, in its plane: 0, or
// outside: -1.
int InnerSide(const FacetPoints& facet, const Eigen::Vector3d& point) {
  return Orientation(facet[0], facet[1], facet[2], point);
}

}  // namespace

uint32_t Locate(const Tetrahedralization& tetrahedra,
                const Eigen::Vector3d& point, uint32_t hint) {
  uint32_t cell_index = hint;
  uint32_t previous = kNone;
  while (!tetrahedra.IsInfinite(cell_index)) {
    const Tetrahedralization::Cell& cell = tetrahedra.cells[cell_index];
    uint32_t next = kNone;
    for (int i = 0; i < 4 && next == kNone; ++i) {
      if (cell.neighbors[i] != previous &&
          InnerSide(PointsOfFacet(tetrahedra, cell_index, i), point) < 0) {
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
    const FacetPoints facet = PointsOfFacet(tetrahedra, cell_index, i);
    const bool leaves = InnerSide(facet, origin) == 0 &&
                        RaySideExact(facet[0], target, facet[1], facet[2]) < 0;
    if (leaves) {
      cell_index = tetrahedra.cells[cell_index].neighbors[i];
    }
    i = leaves ? 0 : i + 1;
  }
  return cell_index;
}

bool IsStrictlyInside(const Tetrahedralization& tetrahedra, uint32_t cell_index,
                      const Eigen::Vector3d& point) {
  for (int i = 0; i < 4; ++i) {
    if (InnerSide(PointsOfFacet(tetrahedra, cell_index, i), point) <= 0) {
      return false;
    }
  }
  return true;
}

}  // namespace colmap_ext
