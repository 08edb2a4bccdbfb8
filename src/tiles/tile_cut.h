#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "base/mix_bits.h"
#include "delaunay/tetrahedralization.h"
#include "delaunay/visibility_weights.h"
#include "optim/min_cut.h"
#include "scene/progress.h"
#include "tiles/plan_vertices.h"

namespace colmap_ext {

// Translates vertex indices of a tile into the plan's. The vertex at infinity
// keeps its index.
inline std::array<uint32_t, 4> IdsOf(std::array<uint32_t, 4> vertices,
                                     const std::vector<uint32_t>& ids) {
  for (uint32_t& vertex : vertices) {
    vertex = vertex == kInfiniteVertex ? vertex : ids[vertex];
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

// Label of a cell.
inline constexpr uint8_t kMatter = 0;
inline constexpr uint8_t kFreeSpace = 1;
inline constexpr uint8_t kNotKnown = 2;

// Where a cell lies.
enum class CellPlace : uint8_t {
  kInner,   // all its neighbors are of the part
  kShared,  // of the part, and of others
  kBeyond,  // not of the part
};

// Labels of the nodes of a part of a graph.
struct PartLabels {
  std::vector<uint8_t>
      known;  // [N] one of the above; kNotKnown beyond the part
  std::vector<uint8_t> guesses;  // [N] of the minimum cut of the graph as it is
};

// In place of a number of rings.
inline constexpr int kAllAtOnce = -1;

struct TileCutOptions {
  VisibilityWeightOptions rays;
  double quality_regularization = 1;
  // Cells within so many of those that are shared are left to the cut of the
  // seams. kAllAtOnce: all that the cut of all tiles could label otherwise;
  // they are cut, and singular vertices are fixed, in one go.
  int seam_rings = 4;
};

// A tile, and the votes and labels of its star cells.
struct TileCut {
  TileTetrahedra tile;
  // [cells] kInner and kShared are the star cells that belong to the tile
  // (PlanBlocks::OwnerOf).
  std::vector<CellPlace> places;
  FlowCapacities graph;  // [cells] as that of all cells of the plan, for the
                         // arcs from and to those
  PartLabels labels;     // [cells] LabelPart() of those
  RayReport rays;        // walked here
};

// Triangulates a tile, counts the votes of all rays of the plan that pass its
// cells, and cuts.
// \param centers [views] camera centres, world frame
TileCut CutTile(const PlanVertices& plan, uint32_t tile,
                const std::vector<Eigen::Vector3d>& centers,
                const TileCutOptions& options, const Progress& progress = {});

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
