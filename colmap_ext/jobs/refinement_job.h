#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include <Eigen/Geometry>

#include "colmap_ext/jobs/plan.h"
#include "tiles/surface_patches.h"
#include "tiles/tile_cells.h"

namespace colmap_ext {

// Input of the job that refines a tile, from the plan.
struct RefinementJob {
  std::filesystem::path folder;
  uint32_t tile;
  Plan plan;
  RefinementPlan refinement;
  TileCells cells;
  std::vector<uint32_t> before;  // tiles of lower colours

  uint32_t Color(uint32_t of) const { return refinement.tiles[of].color; }

  // Where vertices are refined.
  Eigen::AlignedBox3f Reach() const;
  bool IsFree(const Eigen::Vector3f& vertex) const;
};

// \throw FileError if there is no such tile, or no plan of its refinement
RefinementJob MakeRefinementJob(const std::filesystem::path& folder,
                                uint32_t tile);

// \throw FileError if one of the tiles is not refined
void ExpectRefined(const std::filesystem::path& folder,
                   const RefinementPlan& plan,
                   const std::vector<uint32_t>& tiles);

// What the job refines, and from where it is seen.
struct RefinementTarget {
  Eigen::AlignedBox3f box;      // of the facets that change
  std::vector<uint32_t> views;  // ascending
};

RefinementTarget FindTarget(const RefinementJob& job,
                            const SurfaceStore& store);

// The target, and all that is fixed and may hide it; its mesh is manifold.
SurfacePart GatherPart(const RefinementJob& job, const RefinementTarget& target,
                       const SurfaceStore& store);

// \return [V] of a part
FixedVertices FixedIn(const RefinementJob& job, const SurfacePart& part);

}  // namespace colmap_ext
