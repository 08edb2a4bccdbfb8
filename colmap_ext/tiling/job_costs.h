#pragma once

#include <cstddef>

#include "colmap_ext/tiling/plan.h"

namespace colmap_ext {

// What a tile's job takes, with others all around it: fitted to tiles of
// fountain side by side, of 160,000 and 1,900,000 vertices
// (docs/benchmarks.md).
double TileMemoryGb(size_t num_vertices);
double TileSeconds(size_t num_vertices);
// ... and the merger, which holds one tile's cells with the seams and the rings
// around singular vertices there, then the whole surface.
double MergerMemoryGb(const Plan& plan);

}  // namespace colmap_ext
