#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/mix_bits.h"
#include "delaunay/tetrahedralization.h"
#include "optim/min_cut.h"
#include "tiles/tile_cut.h"
#include "tiles/tile_labels.h"

namespace colmap_ext {

// A cell by the plan's vertices at its corners, ascending; kInfiniteVertex is
// the last. A facet likewise.
using CellKey = std::array<uint32_t, 4>;
using FacetKey = std::array<uint32_t, 3>;

template <size_t kSize>
std::array<uint32_t, kSize> Sorted(std::array<uint32_t, kSize> ids) {
  std::ranges::sort(ids);
  return ids;
}

// For tables by key.
struct KeyHash {
  template <size_t kSize>
  size_t operator()(const std::array<uint32_t, kSize>& key) const {
    uint64_t hash = 0;
    for (const uint32_t id : key) {
      hash = MixBits(hash + kSplitMixStep + id);
    }
    return hash;
  }
};

// In place of the label of a cell that does not belong to the tile.
inline constexpr uint8_t kOutside = 3;

// A cell of the tile whose label it could not determine, with all that the cut
// of the seams needs. Arrays of four are by the corners of the key: what lies
// across the facet opposite to each.
struct UnknownCell {
  CellKey key;
  std::array<uint32_t, 4> apexes;  // the vertex across that is not the facet's
  std::array<uint8_t, 4> labels;   // kMatter ... kOutside, of the cell across
  std::array<uint32_t, 4> out;     // capacity of the arc to it
  std::array<uint32_t, 4> back;    // and of the one from it
  uint32_t source;
  uint32_t sink;
  uint32_t guess;  // kMatter or kFreeSpace, by the tile's own cut

  bool operator==(const UnknownCell&) const = default;
};

// A cell of the tile with vertices of others, too, whose label is known.
struct SharedCell {
  CellKey key;
  uint32_t label;  // kMatter or kFreeSpace; as wide as the key, without gaps
};

// The result of a tile for the cut of the seams; keys ascend.
struct TileSeam {
  std::vector<UnknownCell> unknown;
  std::vector<SharedCell> shared;
};

TileSeam SeamOf(const TileCut& cut);

// The result of a tile for the surface.
struct TilePart {
  // All points are 0.
  TileTetrahedra tile;
  std::vector<uint8_t> labels;  // [cells]; kNotKnown where it is not the tile's
};

// The vertices of a part.
struct PartVertices {
  std::vector<uint32_t> ids;          // [V] as TileTetrahedra has them
  std::vector<uint32_t> first_cells;  // [V] Tetrahedralization::vertex_cells
};

// Some consecutive cells of a part.
struct PartCells {
  std::vector<Tetrahedralization::Cell> cells;
  std::vector<uint8_t> labels;
  FlowCapacities graph;
};

// The results of the tiles of a plan, read one after the other.
class TileParts {
 public:
  virtual ~TileParts() = default;
  virtual TileSeam ReadSeam(uint32_t tile) const = 0;
  virtual TilePart ReadPart(uint32_t tile) const = 0;
  virtual PartVertices ReadVertices(uint32_t tile) const = 0;
  virtual uint32_t NumCells(uint32_t tile) const = 0;
  // \param begin, end  cells
  virtual PartCells ReadCells(uint32_t tile, uint32_t begin,
                              uint32_t end) const = 0;
};

}  // namespace colmap_ext
