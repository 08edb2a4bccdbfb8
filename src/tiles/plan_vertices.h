#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "base/rows.h"
#include "delaunay/thinning.h"
#include "delaunay/visibility_weights.h"
#include "mesh/surface.h"
#include "meshing/ray_ends.h"
#include "scene/view.h"

namespace colmap_ext {

// Out-of-core block index of all vertices of a plan. Vertices are numbered tile
// after tile, and along a space-filling curve in each tile; a block is a range
// of them within one tile.
struct PlanBlocks {
  std::vector<uint32_t> tile_begins{0};    // [tiles + 1], blocks
  std::vector<uint32_t> begins{0};         // [blocks + 1], vertices
  std::vector<Eigen::AlignedBox3f> boxes;  // [blocks] of the vertices
  Rows<uint32_t> views;  // [blocks] those that see any of the vertices
  std::vector<uint8_t> have_ends;  // [blocks] 1: some are ends of rays
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();  // of all positions

  size_t NumTiles() const { return tile_begins.size() - 1; }
  size_t NumBlocks() const { return boxes.size(); }
  uint32_t NumVertices() const { return begins.back(); }

  // The mean of all positions, which lies within their hull.
  Eigen::Vector3d Center() const { return sum / NumVertices(); }

  // The first vertex of a tile; of the number of tiles: the end.
  uint32_t FirstVertex(size_t tile) const { return begins[tile_begins[tile]]; }

  uint32_t TileOf(uint32_t vertex) const;

  // The tile that a cell belongs to: the one that most of its finite corners
  // are of, the first of several.
  uint32_t OwnerOf(const std::array<uint32_t, 4>& corners) const;
  uint32_t BlockOf(uint32_t vertex) const;
};

// How many vertices a block has; the last one of a tile may have less.
inline constexpr uint32_t kBlockVertices = 512;

// Adds the blocks of one more tile.
// \param positions    of its vertices
// \param observations of its vertices, by rows
// \throw std::invalid_argument if the plan has more vertices than 32 bits can
//        number; the blocks stay as they are.
void AddTile(const std::vector<Eigen::Vector3f>& positions,
             const Observations& observations, PlanBlocks* blocks);

// The vertices of a plan, to be read where they are needed. All positions
// differ. Reading is safe from several threads.
class PlanVertices {
 public:
  virtual ~PlanVertices() = default;

  virtual const PlanBlocks& Blocks() const = 0;

  // \param begin, end  vertices of one tile
  virtual std::vector<Eigen::Vector3f> ReadPositions(uint32_t begin,
                                                     uint32_t end) const = 0;
  virtual Observations ReadObservations(uint32_t begin, uint32_t end) const = 0;
};

// Positions of vertices, whichever tiles they are of.
// \param ids  ascending
std::vector<Eigen::Vector3f> PositionsOf(const PlanVertices& plan,
                                         const std::vector<uint32_t>& ids);

// Of the edges of a tile's own tetrahedra, scene units.
struct EdgeSample {
  float percentile = 0;        // kSigmaPercentile
  std::vector<float> lengths;  // ascending, every so many of them
  size_t num_edges = 0;
};

// The vertices that a tile's points leave, and what belongs to them.
struct TileVertices {
  std::vector<Eigen::Vector3f> positions;  // [V] along the curve
  Observations observations;               // [V] of the points they stand for,
                                           // with what are ends of rays
  std::vector<float> supports;             // [V] SupportOfVertices()
  std::vector<float> noises;               // [V] LocalNoise() of the points
  VertexAttributes attributes;             // [V] AttributesOfPoints()
  EdgeSample edges;
};

// Thins the points of a tile by themselves: what is kept depends on no other
// tile.
// \param weighted  the points, and the ends of rays that lie in the tile
// \pre the cloud has points
TileVertices ThinTile(WeightedCloud weighted, const std::vector<View>& views,
                      const ThinningOptions& options);

// kSigmaPercentile of the lengths of all tiles' edges; of one tile's the very
// one that its mesher has. 0 where there are none.
float MergedPercentile(const std::vector<EdgeSample>& samples);

}  // namespace colmap_ext
