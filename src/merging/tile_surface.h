#pragma once

#include <cstdint>
#include <vector>

#include "merging/labeled_parts.h"
#include "mesh/triangle_mesh.h"
#include "tiles/cell_key.h"

namespace colmap_ext {

// The partner of a half-edge that two facets at its edge alone do not tell.
// Vertices are the plan's.
struct PartnerFix {
  FacetKey facet;
  uint32_t from;
  uint32_t to;
  bool has_partner;
  FacetKey partner;
};

// The part of a plan's surface that belongs to one tile: the facets whose first
// vertex is of the tile.
struct TileSurface {
  std::vector<Facet> facets;      // of the plan's vertices and centroids
  std::vector<PartnerFix> fixes;  // at edges whose first vertex is of the tile
};

// The tile's part of the surface between free space and matter of a whole plan.
// All cells at a tile's vertices are in its part, so that no facet is missing
// or there twice.
TileSurface SurfaceOf(const LabeledParts& parts, uint32_t tile);

}  // namespace colmap_ext
