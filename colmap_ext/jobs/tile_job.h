#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include <Eigen/Geometry>

#include "colmap_ext/jobs/job_inputs.h"
#include "colmap_ext/jobs/plan.h"
#include "colmap_ext/jobs/refinement_input.h"
#include "scene/picture_decoder.h"
#include "scene/progress.h"
#include "tiles/surface_patches.h"
#include "tiles/tile_cells.h"

namespace colmap_ext {

// The job that refines a tile of a plan.
//
// The job's facets are those in the tile's cell and a margin around it, except
// those that the tiles of lower colours have refined in their own cells. All
// other facets are fixed; they are read if they may hide the tile from a
// camera.
struct TileJob {
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
TileJob MakeTileJob(const std::filesystem::path& folder, uint32_t tile);

// \throw FileError if one of the tiles is not refined
void ExpectRefined(const std::filesystem::path& folder,
                   const RefinementPlan& plan,
                   const std::vector<uint32_t>& tiles);

// The tile, and all around it that may hide it.
struct TileInput {
  SurfacePart part;             // its mesh is manifold
  FixedVertices fixed;          // [V] of the part
  std::vector<uint32_t> views;  // of the plan, ascending, that see the tile
  RefinementInput input;        // of these views
  JobInputs inputs;             // what the result depends on

  // Too few views leave the tile as it is; nothing else is read then.
  bool HasViews() const { return views.size() > 1; }
};

// \throw FileError if something is missing, damaged or of another plan, or an
//        image or a mask has changed
TileInput ReadTileInput(const TileJob& job, const RefinerOptions& options,
                        const PictureDecoder& decoder,
                        const Progress& progress);

// The result as the patch of the tile.
TilePatch MakePatch(const TileJob& job, const TileInput& tile,
                    RefinedMesh refined);

}  // namespace colmap_ext
