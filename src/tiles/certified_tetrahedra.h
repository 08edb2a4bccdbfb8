#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "delaunay/tetrahedralization.h"
#include "scene/progress.h"
#include "tiles/plan_vertices.h"

namespace colmap_ext {

// The plan's vertex of another numbering's; that at infinity is the same.
inline uint32_t IdOf(uint32_t vertex, const std::vector<uint32_t>& ids) {
  return vertex == kInfiniteVertex ? vertex : ids[vertex];
}

inline std::array<uint32_t, 4> IdsOf(std::array<uint32_t, 4> vertices,
                                     const std::vector<uint32_t>& ids) {
  for (uint32_t& vertex : vertices) {
    vertex = IdOf(vertex, ids);
  }
  return vertices;
}

// The Delaunay tetrahedralization of a part of a plan's vertices. All cells at
// the tile's own vertices, its *star cells*, and the cells beside those, are
// cells of the tetrahedralization of all vertices of the plan, and all of that
// one's at these vertices are there.
struct TileTetrahedra {
  Tetrahedralization tetrahedra;
  std::vector<uint32_t> ids;  // [V] the plan's vertex of each, ascending in the
                              // tile's own, which come first, and in the others
  uint32_t num_own = 0;
  size_t num_rounds = 0;  // until no vertex was missing

  bool IsStarCell(uint32_t cell) const {
    return std::ranges::any_of(
        tetrahedra.cells[cell].vertices,
        [this](uint32_t vertex) { return vertex < num_own; });
  }

  // The plan's vertices at the corners of a cell.
  std::array<uint32_t, 4> CornersOf(uint32_t cell) const {
    return IdsOf(tetrahedra.cells[cell].vertices, ids);
  }
};

// Starts from the tile's own vertices, those of the blocks around them, and the
// fewer of the others the farther they are. Then each zone of conflict of the
// cells in question is searched for vertices of the plan that are missing,
// which are inserted, until there are none: an empty sphere is all that
// Delaunay asks for. The result does not depend on the number of threads.
//
// \throw std::invalid_argument where the vertices do not span a volume, or are
//        too many for 32-bit cell indices
TileTetrahedra CertifyTile(const PlanVertices& plan, uint32_t tile,
                           const Progress& progress = {});

}  // namespace colmap_ext
