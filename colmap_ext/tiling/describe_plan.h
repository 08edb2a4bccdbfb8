#pragma once

#include "colmap_ext/options/tiling_options.h"
#include "colmap_ext/tiling/plan.h"
#include "workspace/find_workspace.h"

namespace colmap_ext {

// A plan's inputs and options, which its identity depends on, without tiles.
// \throw FileError if the cameras are missing
Plan DescribePlan(const PlannerOptions& options, const FusedFiles& files);

}  // namespace colmap_ext
