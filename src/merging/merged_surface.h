#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "merging/tile_surface.h"
#include "meshing/surface_extraction.h"
#include "tiles/plan_vertices.h"

namespace colmap_ext {

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
