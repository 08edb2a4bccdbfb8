#pragma once

#include <cstdint>
#include <vector>

#include "mesh/triangle_mesh.h"
#include "meshing/surface_extraction.h"
#include "tiles/cell_key.h"
#include "tiles/plan_vertices.h"
#include "tiles/seam_cut.h"
#include "tiles/singular_patch.h"
#include "tiles/tile_part.h"

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
// vertex is of the tile. Facets of centroids alone belong to the last tile.
struct TileSurface {
  std::vector<Facet> facets;      // of the plan's vertices and centroids
  std::vector<uint32_t> touched;  // the tile's vertices at facets of others,
                                  // ascending
  std::vector<PartnerFix> fixes;  // at edges whose first vertex is of the tile
};

// The surface between free space and matter of a whole plan, tile by tile. All
// cells at a tile's vertices are in its part, so that no facet is missing or
// there twice. Facets with a vertex that has changed come from the patch, after
// those of the tile's part.
class PlanSurface {
 public:
  // \pre all of these outlive it
  PlanSurface(const PlanVertices& plan, const TileParts& parts,
              const SeamLabels& seam, const SingularPatch& patch);

  TileSurface Read(uint32_t tile) const;

  // At edges that have vertices that have changed.
  const std::vector<PartnerFix>& PatchFixes() const { return patch_fixes_; }

 private:
  uint32_t TileOf(const Facet& facet) const;
  bool HasChanged(uint32_t id) const { return patch_.changed.contains(id); }

  const PlanBlocks& blocks_;
  const TileParts& parts_;
  const SeamLabels& seam_;
  const SingularPatch& patch_;
  std::vector<Facet> patch_facets_;
  std::vector<PartnerFix> patch_fixes_;
};

}  // namespace colmap_ext
