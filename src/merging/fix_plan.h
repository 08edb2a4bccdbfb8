#pragma once

#include "merging/cell_changes.h"
#include "merging/seam_labels.h"
#include "meshing/manifold_fixing.h"
#include "scene/progress.h"
#include "tiles/plan_vertices.h"
#include "tiles/tile_part.h"

namespace colmap_ext {

// Fixes the singular vertices of a plan (FixSingularVertices), tile by tile: in
// two rings of cells around them, whichever tiles these are of, with what has
// been changed before. Flips at a vertex concern its own cells, and are judged
// by the cells of their vertices. Rings around vertices that become singular on
// the way are added then. So it takes memory for the rings of one tile, and for
// one tile.
//
// \param at_once  all tiles in one go: the result is that of one machine
// \return num_singular_raw counts those that are singular when it is the turn
//         of their tile
FixingReport FixPlan(const PlanVertices& plan, const TileParts& parts,
                     const SeamLabels& seam, FixingRule rule, bool at_once,
                     CellChanges* changes, const Progress& progress = {});

}  // namespace colmap_ext
