#pragma once

#include <cstdint>
#include <vector>

#include "mesh/fan_split.h"
#include "meshing/manifold_meshing.h"

namespace colmap_ext {

// Drops what the options want dropped from the surface and makes what is left
// manifold again. Facets that have an end of rays as a corner are dropped, too,
// as nothing tells whether there is a surface.
// \param is_end  [V] of the tetrahedralization, see MarkEnds()
// \param surface its sources are vertices of the tetrahedralization
// \param report  gets the counts of what is dropped
void FilterSurface(const ManifoldMeshingOptions& options,
                   const std::vector<uint8_t>& is_end, FanSplit* surface,
                   ManifoldMeshingReport* report);

}  // namespace colmap_ext
