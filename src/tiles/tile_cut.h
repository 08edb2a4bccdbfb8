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

namespace colmap_ext {

struct TileCutOptions {
  VisibilityWeightOptions rays;
  double quality_regularization = 1;
};

// A tile with what the votes and the cut say of its star cells.
struct TileCut {
  TileTetrahedra tile;
  FlowCapacities graph;  // [cells] as that of all cells of the plan, for the
                         // arcs from and to star cells
  std::vector<uint8_t> labels;  // [cells] PersistentLabels() of the star cells
  RayReport rays;               // walked here
};

// Triangulates a tile, counts the votes of all rays of the plan that pass its
// star cells, and cuts.
// \param centers [views] camera centres, world frame
TileCut CutTile(const PlanVertices& plan, uint32_t tile,
                const std::vector<Eigen::Vector3d>& centers,
                const TileCutOptions& options, const Progress& progress = {});

}  // namespace colmap_ext
