#include "colmap_ext/tiling/job_costs.h"

#include <algorithm>
#include <cmath>

#include "tiles/tile_cut.h"

namespace colmap_ext {

namespace {

// Of a tile within others, its own vertices and those of others that its job
// holds, which lie along the borders.
double NumHeld(size_t num_vertices) {
  const auto own = static_cast<double>(num_vertices);
  return own + 640 * std::sqrt(own);
}

}  // namespace

double TileMemoryGb(size_t num_vertices) {
  return 0.06 + 830e-9 * NumHeld(num_vertices);
}

double TileSeconds(size_t num_vertices) {
  return 1 + 60e-6 * NumHeld(num_vertices);
}

double MergerMemoryGb(const Plan& plan) {
  // The cells of one tile, without its rays, and the seams read last.
  constexpr double kSeamsGb = 0.07;
  double num_vertices = 0;
  double largest = 0;
  for (const PlannedTile& tile : plan.tiles) {
    num_vertices += static_cast<double>(tile.num_vertices);
    largest = std::max(largest, static_cast<double>(tile.num_vertices));
  }
  const double all_seams =
      plan.seam_rings == kAllAtOnce ? 600e-9 * num_vertices : 0;
  return std::max(
      kSeamsGb + TileMemoryGb(static_cast<size_t>(largest)) + all_seams,
      0.06 + 390e-9 * num_vertices);
}

}  // namespace colmap_ext
