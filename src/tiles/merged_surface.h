#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "meshing/surface_extraction.h"
#include "tiles/cell_changes.h"
#include "tiles/plan_vertices.h"

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
// or duplicated.
TileSurface SurfaceOf(const LabeledParts& parts, uint32_t tile);

// The surface of a plan.
struct MergedSurface {
  ExtractedSurface extracted;
  std::vector<uint32_t> ids;  // [V] the plan's vertex of each, ascending; those
                              // from its number on are centroids
};

// Positions of the plan's vertices and of centroids.
// \param centroids  of split cells, those from the plan's number of vertices on
// \param ids  ascending
std::vector<Eigen::Vector3f> PositionsOf(
    const PlanVertices& plan, const std::vector<Eigen::Vector3f>& centroids,
    const std::vector<uint32_t>& ids);

// The whole surface; facets are in the order of the tiles.
MergedSurface MergeSurface(const PlanVertices& plan, const LabeledParts& parts,
                           const std::vector<Eigen::Vector3f>& centroids);

}  // namespace colmap_ext
