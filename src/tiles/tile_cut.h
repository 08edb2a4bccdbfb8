#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "delaunay/visibility_weights.h"
#include "optim/min_cut.h"
#include "scene/progress.h"
#include "tiles/certified_tetrahedra.h"
#include "tiles/plan_vertices.h"
#include "tiles/tile_labels.h"

namespace colmap_ext {

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

}  // namespace colmap_ext
