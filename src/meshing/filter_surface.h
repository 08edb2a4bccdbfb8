#pragma once

#include <cstdint>
#include <vector>

#include "mesh/manifold_repair.h"
#include "meshing/manifold_meshing.h"
#include "meshing/surface_extraction.h"

namespace colmap_ext {

// Makes a surface manifold, drops facets that have an end of rays as a corner
// (there is no evidence of a surface) and those that the options exclude, and
// makes the remaining surface manifold again. Facets keep the order of the
// input facets that they are parts of; vertices are in the order of their use.
// \param is_end  [V] of the tetrahedralization, see MarkEnds()
// \param report  gets the counts of what is dropped, copied and split
// \return its sources are vertices of the tetrahedralization
FanSplit SplitAndFilter(const ManifoldMeshingOptions& options,
                        ExtractedSurface extracted,
                        const std::vector<uint8_t>& is_end,
                        ManifoldMeshingReport* report);

}  // namespace colmap_ext
