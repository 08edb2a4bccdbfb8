#pragma once

#include <cstdint>
#include <vector>

#include "mesh/fan_split.h"
#include "meshing/manifold_meshing.h"
#include "meshing/surface_extraction.h"

namespace colmap_ext {

// Makes a surface manifold, drops facets that have an end of rays as a corner,
// as nothing tells whether there is a surface, and what the options want
// dropped, and makes what is left manifold again. Facets come out in the order
// of those that they are parts of, vertices in the order of their use.
// \param is_end  [V] of the tetrahedralization, see MarkEnds()
// \param report  gets the counts of what is dropped, copied and split
// \return its sources are vertices of the tetrahedralization
FanSplit SplitAndFilter(const ManifoldMeshingOptions& options,
                        ExtractedSurface extracted,
                        const std::vector<uint8_t>& is_end,
                        ManifoldMeshingReport* report);

}  // namespace colmap_ext
