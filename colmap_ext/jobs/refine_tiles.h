#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include <Eigen/Geometry>

#include "colmap_ext/jobs/plan.h"
#include "colmap_ext/jobs/refinement_input.h"
#include "scene/images.h"
#include "scene/progress.h"
#include "tiles/surface_patches.h"
#include "tiles/tile_cells.h"

// The jobs that refine the mesh of a plan tile by tile.
namespace colmap_ext {

struct RefinementPlanReport {
  bool is_kept = false;    // the same plan was there: nothing was done
  bool is_locked = false;  // see FolderLock
  size_t num_vertices = 0;
  size_t num_facets = 0;
};

// Plans how the mesh of a plan is refined tile by tile: copies it into the
// plan's folder, in blocks that jobs read where they need them, and gives tiles
// colours. Holds the mesh.
// \param mesh_path  as mesh_merger has written it, with its .vis
// \throw FileError if a file is missing, damaged, or of another plan, or can
//        not be written, or where another planner is at work
RefinementPlan PlanRefinement(const std::filesystem::path& folder,
                              const std::filesystem::path& mesh_path,
                              const RefinerOptions& options,
                              const Progress& progress,
                              RefinementPlanReport* report);

// Where a plan's pictures lie.
std::filesystem::path ImagesPath(const Plan& plan);

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

// The refined surface of a plan, all of whose tiles are refined: their patches
// put together, borders and self-intersections as RefineFacetwise() leaves
// them.
// \throw FileError if a tile is not refined, or patches do not fit together
RefinedMesh MergeRefined(const std::filesystem::path& folder,
                         const Progress& progress);

}  // namespace colmap_ext
