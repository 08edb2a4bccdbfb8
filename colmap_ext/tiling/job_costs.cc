#include "colmap_ext/tiling/job_costs.h"

#include <algorithm>
#include <cmath>

namespace colmap_ext {

double TileMemoryGb(size_t num_vertices) {
  // Others lie along the borders.
  const auto own = static_cast<double>(num_vertices);
  const double others = 600 * std::sqrt(own);
  return 0.06 + 700e-9 * (own + others);
}

double TileSeconds(size_t num_vertices) {
  return 1 + 90e-6 * static_cast<double>(num_vertices);
}

double MergerMemoryGb(const Plan& plan) {
  double num_vertices = 0;
  double largest = 0;
  for (const PlannedTile& tile : plan.tiles) {
    num_vertices += static_cast<double>(tile.num_vertices);
    largest = std::max(largest, static_cast<double>(tile.num_vertices));
  }
  const double fixing = 200e-9 * num_vertices + 800e-9 * largest;
  const double repairing = 350e-9 * num_vertices;
  return 0.1 + std::max(fixing, repairing);
}

}  // namespace colmap_ext
