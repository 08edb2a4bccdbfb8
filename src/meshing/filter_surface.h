#pragma once

#include <cstdint>
#include <vector>

#include "mesh/fan_split.h"
#include "meshing/manifold_meshing.h"
#include "meshing/surface_extraction.h"

namespace colmap_ext {

// What FilterSurface() has to know of the whole surface.
struct SurfaceLimits {
  double longest_side = 0;       // of a facet, scene units
  float largest_coordinate = 0;  // of a vertex
};

// \param mesh  the whole surface
SurfaceLimits LimitsOf(const ManifoldMeshingOptions& options,
                       const TriangleMesh& mesh);

// Makes a surface manifold. Facets that have an end of rays as a corner are
// dropped then, as nothing tells whether there is a surface.
// \param is_end  [V] of the tetrahedralization, see MarkEnds()
// \param is_counted  [F] 1: what is made of the facet counts; empty: all does
// \return its sources are vertices of the tetrahedralization, and facets of the
//         surface
FanSplit SplitWithoutEnds(const ExtractedSurface& extracted,
                          const std::vector<uint8_t>& is_end,
                          const std::vector<uint8_t>& is_counted = {});

// Drops what the options want dropped from the surface and makes what is left
// manifold again. Facets come out in the order of those that they are parts of,
// vertices in the order of their use.
// \param is_counted  as above
// \param surface of SplitWithoutEnds()
// \param report  gets the counts of what is dropped, copied and split
void FilterSurface(const ManifoldMeshingOptions& options,
                   const SurfaceLimits& limits,
                   const std::vector<uint8_t>& is_counted, FanSplit* surface,
                   ManifoldMeshingReport* report);

}  // namespace colmap_ext
