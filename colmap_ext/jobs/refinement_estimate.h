#pragma once

#include <vector>

#include "colmap_ext/jobs/plan.h"
#include "mesh/surface.h"

namespace colmap_ext {

// What a square pixel of surface takes, GB, as a rule; and at most, for jobs
// whose memory is limited.
inline constexpr double kUsualGbPerPixel = 5e-8;
inline constexpr double kBoundGbPerPixel = 1.25e-7;

// Disk space, GB per square pixel of surface: the mesh with its .vis, and the
// state that --resume reads.
inline constexpr double kDiskGbPerPixel = 6e-9;

// Sets what the job that refines a tile takes by `pixels` of surface: its
// memory, that of each of its threads, and its time.
// \param views  that see the tile.
// \param max_memory_gb  see RefinerOptions.
void EstimateRefinement(const std::vector<View>& views, double max_memory_gb,
                        double gb_per_pixel, RefinementTile* tile);

// The same of all tiles, by the surface and the views that each of them has.
// \param tiles  [cells] with their margins
void EstimateJobs(const Surface& surface, const TileCells& cells,
                  const std::vector<View>& views, double max_memory_gb,
                  double gb_per_pixel, std::vector<RefinementTile>* tiles);

// What a run without tiles takes, as a rule.
RefinementTile EstimateRun(const Surface& surface,
                           const std::vector<View>& views,
                           double max_memory_gb);

}  // namespace colmap_ext
