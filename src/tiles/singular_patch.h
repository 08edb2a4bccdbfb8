#pragma once

#include <cstddef>
#include <cstdint>
#include <unordered_set>
#include <vector>

#include "delaunay/tetrahedralization.h"
#include "meshing/manifold_fixing.h"
#include "optim/min_cut.h"
#include "tiles/plan_vertices.h"
#include "tiles/seam_cut.h"
#include "tiles/tile_part.h"

namespace colmap_ext {

// The cells around the singular vertices of a plan, whichever tiles they are
// of, with the labels that fixing gives them.
struct SingularPatch {
  Tetrahedralization tetrahedra;  // the first cell is beside those that are
                                  // not there, and is free space
  std::vector<uint32_t> ids;      // [V] the plan's, ascending; those from its
                              // number of vertices on are centroids of split
                              // cells
  std::vector<uint8_t> labels;  // [cells]
  // The plan's vertices and centroids at cells that were relabelled or split.
  std::unordered_set<uint32_t> changed;
  FixingReport report;
};

// Finds all singular vertices and fixes them (FixSingularVertices), in two
// rings of cells around them: flips at a vertex concern its own cells, and are
// judged by the cells of their vertices. Rings around vertices that become
// singular on the way are added then. So it takes memory for the rings and for
// one tile at a time.
SingularPatch FixPatches(const PlanVertices& plan, const TileParts& parts,
                         const SeamLabels& seam, FixingRule rule);

}  // namespace colmap_ext
