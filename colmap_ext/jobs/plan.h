#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "colmap_ext/jobs/job_file.h"
#include "colmap_ext/options/meshing_options.h"
#include "colmap_ext/options/refinement_options.h"
#include "scene/region.h"
#include "scene/view.h"
#include "tiles/tile_cells.h"

namespace colmap_ext {

// A tile and the estimated costs of its job.
struct PlannedTile {
  uint64_t num_points = 0;
  uint64_t num_vertices = 0;
  uint64_t num_rays = 0;
  double memory_gb = 0;
  double core_seconds = 0;
  Eigen::AlignedBox3f cell;  // of its points, see SplitTree::Cells()
};

// PLAN/plan.json: all that the jobs of a plan share but the vertices.
struct Plan {
  std::filesystem::path folder;  // where the plan lies
  std::filesystem::path workspace_path;
  std::filesystem::path sparse_path;  // folder of the sparse model
  JobInputs inputs;
  uint64_t identity = 0;         // of the inputs
  double distance_sigma = 0;     // scene units
  std::optional<Region> region;  // what is meshed
  std::vector<View> views;
  std::vector<PlannedTile> tiles;
  double merger_memory_gb = 0;

  // Sets the identity.
  void Identify();

  // The options that it was made with, except paths of inputs and outputs.
  // \throw FileError if one has no valid value
  PlannerOptions Options() const;

  TileCells Cells() const;
};

// How a tile of a plan is refined, and the estimated costs of its job.
struct RefinementTile {
  uint32_t color = 0;    // tiles of one colour are refined at once, lower ones
                         // before; see ColorTiles()
  double margin = 0;     // around the tile's cell, scene units
  double facets = 0;     // expected in cell and margin, at the finest level
  double cache_gb = 0;   // for images and what is drawn into them, at most
  double memory_gb = 0;  // expected, without what each thread takes
  double thread_gb = 0;  // each thread
  double core_seconds = 0;
};

// PLAN/refine.json: all that the jobs refining a plan share but the surface.
struct RefinementPlan {
  std::filesystem::path folder;  // of the plan
  JobInputs inputs;              // files by their paths
  uint64_t identity = 0;         // of the inputs and the plan
  std::vector<View> views;       // the plan's, maybe with refined cameras
  std::vector<RadialShifts> radial_shifts;  // [views] of lenses, or empty
  std::vector<RefinementTile> tiles;

  // Sets the folder and the identity.
  void Identify(const Plan& plan);

  uint32_t NumColors() const;

  // The tiles of lower colours than `color`, by colour, then by number.
  std::vector<uint32_t> TilesBefore(uint32_t color) const;
  std::vector<uint32_t> TilesOf(uint32_t color) const;

  // Sets the options that the result depends on.
  // \throw FileError if one has no valid value
  void SetOptions(RefinerOptions* options) const;
};

// Files in a plan's folder.
std::filesystem::path PlanPath(const std::filesystem::path& folder);
std::filesystem::path RefinementPlanPath(const std::filesystem::path& folder);
std::filesystem::path RefinedSparsePath(const std::filesystem::path& folder);

// \throw FileError if it cannot be written
void WritePlan(const Plan& plan);
void WritePlan(const RefinementPlan& plan);

// \throw FileError if there is none, or it is damaged, or of another version
Plan ReadPlan(const std::filesystem::path& folder);

// The same for the job of a tile.
// \throw FileError if there is no such tile, or an input has changed
Plan ReadPlan(const std::filesystem::path& folder, uint32_t tile);

// \param plan  whose mesh is refined
// \throw FileError if there is none, or it is damaged, or of another version or
//        of another plan
RefinementPlan ReadRefinementPlan(const Plan& plan);

// \throw FileError if a file has changed since it was planned with. A file that
//        no longer exists, or was not planned with, is accepted.
void ExpectSame(const Plan& plan);
void ExpectSame(const RefinementPlan& plan, const std::filesystem::path& path);

// What a tile's job takes, with others all around it: fitted to tiles of
// fountain side by side, of 160,000 and 1,900,000 vertices
// (docs/experiments.md).
double TileMemoryGb(size_t num_vertices);
double TileSeconds(size_t num_vertices);
// ... and the merger, which holds one tile's cells with the seams and the rings
// around singular vertices there, then the whole surface.
double MergerMemoryGb(const Plan& plan, const PlannerOptions& options);

// The number of tiles whose jobs fit in options.max_memory_gb.
// \param num_points  of the cloud
size_t NumTilesForMemory(const PlannerOptions& options, size_t num_points);

}  // namespace colmap_ext
