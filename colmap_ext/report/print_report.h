#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "colmap_ext/jobs/run_tile.h"
#include "colmap_ext/report/print_lines.h"
#include "colmap_ext/terminal/progress_reporter.h"
#include "meshing/manifold_meshing.h"
#include "repair/edit_borders.h"
#include "scene/half_pixel.h"
#include "scene/region.h"
#include "workspace/masks.h"
#include "workspace/workspace.h"

namespace colmap_ext {

// Print reports to the user: one fact a line, numbers in one column.

struct HalfPixelReport {
  HalfPixelSlope slope;
  double scale = 1;  // of the correction
};

// The input: what was read, dropped, and why.
// \param half_pixel  if the half pixel was corrected.
void PrintReport(const WorkspaceReport& report, size_t num_images,
                 const std::optional<HalfPixelReport>& half_pixel,
                 ReportLog* log);

// The masked observations.
void PrintReport(const MaskReport& report, ReportLog* log);

// The region; prints nothing without one.
void PrintReport(const std::optional<Region>& region, ReportLog* log);

// Counts of a mesh.
void PrintTopology(const MeshReport& mesh, ReportLog* log);

// The meshing.
void PrintReport(const ManifoldMeshingReport& report, ReportLog* log);

// A tile of a plan.
void PrintReport(const TileReport& report, ReportLog* log);

// The size of a pixel on the mesh, scene units: the scale for distances in
// options.
void PrintFootprint(double footprint, ReportLog* log);

// Trimming and closing of holes; prints nothing if nothing was done.
void PrintReport(const BorderReport& report, ReportLog* log);

// Time and memory.
void PrintReport(const std::vector<StageTime>& stage_times, size_t peak_memory,
                 ReportLog* log);

}  // namespace colmap_ext
