#pragma once

#include <cstdint>
#include <vector>

#include "meshing/surface_extraction.h"
#include "tiles/plan_vertices.h"
#include "tiles/seam_cut.h"
#include "tiles/singular_patch.h"
#include "tiles/tile_part.h"

namespace colmap_ext {

// The surface between free space and matter of a whole plan.
struct MergedSurface {
  ExtractedSurface extracted;
  std::vector<uint32_t> ids;  // [V] the plan's vertex of each, ascending; those
                              // from its number on are centroids
};

// Each facet comes from the tile of its first vertex, or, where that or another
// of its vertices has changed, from the patch. All cells at a tile's vertices
// are there, so that no facet is missing or there twice. Facets are in the
// order of the tiles, those of the patch at last.
MergedSurface MergeSurface(const PlanVertices& plan, const TileParts& parts,
                           const SeamLabels& seam, const SingularPatch& patch);

}  // namespace colmap_ext
