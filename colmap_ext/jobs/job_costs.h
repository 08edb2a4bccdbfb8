#pragma once

#include <cstddef>
#include <vector>

#include "colmap_ext/jobs/plan.h"
#include "scene/view.h"

namespace colmap_ext {

// What a tile's job takes, with others all around it: fitted to tiles of
// fountain side by side, of 160,000 and 1,900,000 vertices
// (docs/experiments.md).
double TileMemoryGb(size_t num_vertices);
double TileSeconds(size_t num_vertices);
// ... and the merger, which holds one tile's cells with the seams and the rings
// around singular vertices there, then the whole surface.
double MergerMemoryGb(const Plan& plan, const PlannerOptions& options);

// Sets what the job that refines a tile takes by `pixels` of surface: its
// memory, that of each of its threads, and its time.
// \param views  that see the tile.
// \param max_memory_gb  see RefinerOptions.
void EstimateRefinement(const std::vector<View>& views, double max_memory_gb,
                        RefinementTile* tile);

}  // namespace colmap_ext
