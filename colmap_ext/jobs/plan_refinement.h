#pragma once

#include <cstddef>
#include <filesystem>

#include "colmap_ext/jobs/plan.h"
#include "colmap_ext/options/refinement_options.h"
#include "scene/progress.h"

namespace colmap_ext {

struct RefinementPlanReport {
  bool is_kept = false;    // the same plan was there: nothing was done
  bool is_locked = false;  // see FolderLock
  size_t num_vertices = 0;
  size_t num_facets = 0;
};

// Plans how the mesh of a plan is refined tile by tile: copies it into the
// plan's folder, in blocks that jobs read where they need them, and gives tiles
// colours. Holds the mesh.
// \param mesh_path  as mesh_merger has written it, with its .vis
// \throw FileError if a file is missing, damaged, or of another plan, or can
//        not be written, or where another planner is at work
RefinementPlan PlanRefinement(const std::filesystem::path& folder,
                              const std::filesystem::path& mesh_path,
                              const RefinerOptions& options,
                              const Progress& progress,
                              RefinementPlanReport* report);

// Where a plan's pictures lie.
std::filesystem::path ImagesPath(const Plan& plan);

}  // namespace colmap_ext
