#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "delaunay/tetrahedralization.h"
#include "delaunay/visibility_weights.h"
#include "meshing/ray_ends.h"
#include "scene/point_cloud.h"
#include "scene/progress.h"
#include "scene/view.h"

namespace colmap_ext {

// Of the edges of a tile's own tetrahedra, scene units.
struct EdgeSample {
  float percentile = 0;        // kSigmaPercentile
  std::vector<float> lengths;  // ascending, every so many of them
  size_t num_edges = 0;
};

// As in COLMAP's delaunay_mesher.
inline constexpr double kSigmaPercentile = 25;

// The vertices that a tile's points leave, and what belongs to them.
struct TileVertices {
  std::vector<Eigen::Vector3f> positions;  // [V] along the curve
  Observations observations;               // [V] of the points they stand for,
                                           // with what are ends of rays
  std::vector<float> supports;             // [V] SupportOfVertices()
  std::vector<float> noises;               // [V] LocalNoise() of the points
  std::vector<Color> colors;               // [V] or empty
  Rows<uint32_t> views;                    // [V] of the vertex's own point
  EdgeSample edges;
};

// Thins the points of a tile by themselves: what is kept depends on no other
// tile. A tile whose points span no volume keeps them all.
// \param weighted  the points, and the ends of rays that lie in the tile
// \pre the cloud has points
TileVertices ThinTile(WeightedCloud weighted, const std::vector<View>& views,
                      const ThinningOptions& options,
                      const Progress& progress = {});

// kSigmaPercentile of the lengths of all tiles' edges; of one tile's the very
// one that its mesher has. 0 where there are none.
float MergedPercentile(const std::vector<EdgeSample>& samples);

}  // namespace colmap_ext
