#pragma once

#include <optional>

#include "colmap_ext/jobs/plan.h"
#include "colmap_ext/options/tiling_options.h"
#include "colmap_ext/report/print_report.h"
#include "scene/picture_decoder.h"
#include "scene/progress.h"
#include "scene/region.h"
#include "workspace/masks.h"
#include "workspace/workspace.h"

namespace colmap_ext {

struct PlanReport {
  bool is_kept = false;    // the same plan was there: nothing was done
  bool is_locked = false;  // see FolderLock
  WorkspaceReport workspace;
  std::optional<HalfPixelReport> half_pixel;
  std::optional<MaskReport> masks;
  std::optional<Region> region;
  size_t num_outside_points = 0;  // beyond the region's margin
  size_t num_ray_ends = 0;        // of a region and of masked pixels
};

// Makes a plan and its files. The points are read twice, piece by piece (three
// times where there are many and the half pixel is calibrated); no more of them
// are held than a few tiles have.
// \throw FileError for whatever is wrong with the workspace, or can not be
//        written, or where another planner is at work
Plan MakePlan(const PlannerOptions& options, const PictureDecoder& decoder,
              const Progress& progress, PlanReport* report);

}  // namespace colmap_ext
