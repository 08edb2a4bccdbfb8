#pragma once

#include <cstdint>
#include <filesystem>

#include "colmap_ext/jobs/plan.h"
#include "delaunay/visibility_weights.h"
#include "scene/progress.h"

namespace colmap_ext {

struct TileReport {
  bool is_kept = false;  // it was done before: nothing was done
  size_t num_vertices = 0;
  size_t num_other_vertices = 0;  // of other tiles that were needed
  size_t num_rounds = 0;          // until none was missing
  size_t num_star_cells = 0;
  size_t num_unknown_cells = 0;  // left to the merger
  RayReport rays;
};

// Does a tile of a plan, once: its file is there whole or not at all.
// \throw FileError if the plan or its files are missing, damaged or of another
//        plan, or there is no such tile, or an input has changed
TileReport RunTile(const std::filesystem::path& folder, uint32_t tile,
                   const Progress& progress);

}  // namespace colmap_ext
