#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>

#include "colmap_ext/jobs/plan.h"
#include "colmap_ext/report/print_report.h"
#include "scene/images.h"
#include "scene/progress.h"

// The jobs that mesh a scene tile by tile.
namespace colmap_ext {

struct PlanReport {
  bool is_kept = false;    // the same plan was there: nothing was done
  bool is_locked = false;  // see FolderLock
  WorkspaceReport workspace;
  std::optional<HalfPixelReport> half_pixel;
  std::optional<MaskReport> masks;
  size_t num_outside_points = 0;  // beyond the region's margin
  size_t num_weaker_points = 0;   // ManifoldMeshingReport
  size_t num_ray_ends = 0;        // of a region and of masked pixels
};

// Makes a plan and its files. The points are read twice, piece by piece (three
// times where there are many and the half pixel is calibrated); no more of them
// are held than a few tiles have.
// \throw FileError for whatever is wrong with the workspace, or cannot be
//        written, or where another planner is at work
Plan MakePlan(const PlannerOptions& options, const PictureDecoder& decoder,
              const Progress& progress, PlanReport* report);

// Does a tile of a plan, once: its file is there whole or not at all.
// \throw FileError if the plan or its files are missing, damaged or of another
//        plan, or there is no such tile, or an input has changed
void MeshTile(const std::filesystem::path& folder, uint32_t tile,
              Console* console);

// Writes the mesh of a plan all of whose tiles are done, as WriteMesh() does,
// and the region that was found for the plan beside it.
// \throw FileError as MeshTile(), where a tile is not done, and where the mesh
//        cannot be written
void MergeTiles(const MergerOptions& options, Console* console);

}  // namespace colmap_ext
