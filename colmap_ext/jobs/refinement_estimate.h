#pragma once

#include <vector>

#include "colmap_ext/jobs/plan.h"
#include "colmap_ext/options/refinement_options.h"
#include "mesh/surface.h"

namespace colmap_ext {

// What a facet takes with all that belongs to it, GB, as a rule; and at most,
// for jobs whose memory is limited.
inline constexpr double kUsualGbPerFacet = 5.2e-7;
inline constexpr double kBoundGbPerFacet = 1.3e-6;

// Disk space, GB per facet: the mesh with its .vis, and the state of --resume.
inline constexpr double kDiskGbPerFacet = 1e-7;

// \return max_memory_gb, or what it stands for on this machine.
double MaxMemoryGb(const RefinerOptions& options);

// Sets what the job that refines a tile takes by its facets: its memory, that
// of each of its threads, and its time by the default options.
// \param views  that see the tile, as they are compared.
// \param num_threads  that share max_memory_gb.
void EstimateRefinement(const std::vector<View>& views, double max_memory_gb,
                        int num_threads, double gb_per_facet,
                        RefinementTile* tile);

// The same of all tiles, by the surface and the views that each of them has.
// \param views  as they are compared.
// \param tiles  [cells] with their margins
void EstimateJobs(const Surface& surface, const TileCells& cells,
                  const std::vector<View>& views, const RefinerOptions& options,
                  double gb_per_facet, std::vector<RefinementTile>* tiles);

// What a run without tiles takes, as a rule.
RefinementTile EstimateRun(const Surface& surface,
                           const std::vector<View>& views,
                           const RefinerOptions& options);

}  // namespace colmap_ext
