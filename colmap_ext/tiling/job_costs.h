#pragma once

#include <cstddef>

#include "colmap_ext/tiling/plan.h"

namespace colmap_ext {

// What a tile's job takes, with others all around it: fitted to tiles of
// fountain side by side, of 160,000 and 1,900,000 vertices
// (docs/benchmarks.md).
double TileMemoryGb(size_t num_vertices);
double TileSeconds(size_t num_vertices);
// ... and the merger, fitted to plans of 4, 16 and one of them. It holds the
// rings around singular vertices and one band of the surface, or all of it.
double MergerMemoryGb(const Plan& plan, bool holds_whole_surface);

}  // namespace colmap_ext
