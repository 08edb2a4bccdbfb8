#pragma once

#include <vector>

#include "colmap_ext/jobs/plan.h"
#include "mesh/surface.h"

namespace colmap_ext {

// Sets what the job that refines a tile takes by `pixels` of surface: its
// memory, that of each of its threads, and its time.
// \param views  that see the tile.
// \param max_memory_gb  see RefinerOptions.
void EstimateRefinement(const std::vector<View>& views, double max_memory_gb,
                        RefinementTile* tile);

// The same of all tiles, by the surface and the views that each of them has.
// \param tiles  [cells] with their margins
void EstimateJobs(const Surface& surface, const TileCells& cells,
                  const std::vector<View>& views, double max_memory_gb,
                  std::vector<RefinementTile>* tiles);

// What a run without tiles takes, as a rule; jobs of tiles have bounds.
struct RefinementEstimate {
  double images_gb = 0;   // that are kept, the program and the threads
  double surface_gb = 0;  // which tiles would share out
  double core_seconds = 0;
};

RefinementEstimate EstimateRun(const Surface& surface,
                               const std::vector<View>& views,
                               double max_memory_gb, int num_threads);

}  // namespace colmap_ext
