#include "tiles/tile_part.h"

#include <algorithm>
#include <numeric>

namespace colmap_ext {
namespace {

uint32_t IdOf(const TileTetrahedra& tile, uint32_t vertex) {
  return vertex == kInfiniteVertex ? vertex : tile.ids[vertex];
}

UnknownCell UnknownOf(const TileCut& cut, uint32_t cell) {
  const Tetrahedralization& tetrahedra = cut.tile.tetrahedra;
  const auto& [vertices, neighbors] = tetrahedra.cells[cell];
  std::array<uint32_t, 4> order = {0, 1, 2, 3};
  std::ranges::sort(order, {}, [&, &corners = vertices](uint32_t k) {
    return IdOf(cut.tile, corners[k]);
  });
  UnknownCell unknown;
  unknown.source = std::min(cut.graph.source[cell], kMaxCapacity);
  unknown.sink = std::min(cut.graph.sink[cell], kMaxCapacity);
  for (int i = 0; i < 4; ++i) {
    const uint32_t k = order[i];
    const uint32_t other = neighbors[k];
    const uint32_t back = tetrahedra.FacetTo(other, cell);
    unknown.key[i] = IdOf(cut.tile, vertices[k]);
    unknown.apexes[i] = IdOf(cut.tile, tetrahedra.cells[other].vertices[back]);
    unknown.labels[i] =
        cut.tile.IsStarCell(other) ? cut.labels[other] : kOutside;
    unknown.out[i] = std::min(cut.graph.capacities[cell][k], kMaxCapacity);
    unknown.back[i] = std::min(cut.graph.capacities[other][back], kMaxCapacity);
  }
  return unknown;
}

}  // namespace

TileSeam SeamOf(const TileCut& cut, const PlanBlocks& blocks) {
  const TileTetrahedra& tile = cut.tile;
  const uint32_t begin = tile.num_own > 0 ? tile.ids[0] : 0;
  const uint32_t home = blocks.TileOf(begin);
  const uint32_t end = blocks.FirstVertex(home + 1);
  TileSeam seam;
  for (uint32_t cell = 0; cell < tile.tetrahedra.cells.size(); ++cell) {
    if (!tile.IsStarCell(cell)) {
      continue;
    }
    if (cut.labels[cell] == kNotKnown) {
      seam.unknown.push_back(UnknownOf(cut, cell));
      continue;
    }
    CellKey key = tile.tetrahedra.cells[cell].vertices;
    bool is_shared = false;
    for (uint32_t& corner : key) {
      corner = IdOf(tile, corner);
      is_shared = is_shared || (corner != kInfiniteVertex &&
                                (corner < begin || corner >= end));
    }
    if (is_shared) {
      seam.shared.push_back({Sorted(key), cut.labels[cell]});
    }
  }
  return seam;
}

}  // namespace colmap_ext
