#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "colmap_ext/jobs/run_tile.h"
#include "colmap_ext/report/print_lines.h"
#include "colmap_ext/terminal/progress_reporter.h"
#include "meshing/manifold_meshing.h"
#include "repair/edit_borders.h"
#include "scene/half_pixel_slope.h"
#include "scene/region.h"
#include "workspace/masks.h"
#include "workspace/workspace.h"

namespace colmap_ext {

// For the user, on the screen: one fact a line, numbers in one column.

struct HalfPixelReport {
  HalfPixelSlope slope;
  double scale = 1;  // of the correction
};

// What was read, and what was dropped and why.
// \param half_pixel  if it was corrected.
void PrintReport(const WorkspaceReport& report, size_t num_images,
                 const std::optional<HalfPixelReport>& half_pixel,
                 ReportLog* log);

// What the masks left out.
void PrintReport(const MaskReport& report, ReportLog* log);

// Where it is meshed or refined: nothing where that is everywhere.
void PrintReport(const std::optional<Region>& region, ReportLog* log);

// What was made of it.
void PrintReport(const ManifoldMeshingReport& report, ReportLog* log);

// What was done of a tile of a plan.
void PrintReport(const TileReport& report, ReportLog* log);

// What a pixel covers on the mesh, scene units, so that distances in options
// can be judged.
void PrintFootprint(double footprint, ReportLog* log);

// What was dropped and closed at its borders: nothing where that is nothing.
void PrintReport(const BorderReport& report, ReportLog* log);

// What it took.
void PrintReport(const std::vector<StageTime>& stage_times, size_t peak_memory,
                 ReportLog* log);

}  // namespace colmap_ext
