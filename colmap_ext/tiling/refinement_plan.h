#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "colmap_ext/options/refinement_options.h"
#include "colmap_ext/tiling/plan.h"

namespace colmap_ext {

// How a tile of a plan is refined, and what its job will take.
struct RefinementTile {
  uint32_t color = 0;    // tiles of one colour are refined at once, lower ones
                         // before; see ColorTiles()
  double margin = 0;     // around the tile's cell, scene units
  double pixels = 0;     // of the surface in cell and margin, px^2
  double memory_gb = 0;  // but for what each thread takes
  double thread_gb = 0;  // each thread
  double seconds = 0;    // of one core
};

// PLAN/refine.json: all that the jobs which refine a plan's mesh share but the
// surface.
struct RefinementPlan {
  uint64_t plan_identity = 0;
  // The mesh, the pictures and their masks with their fingerprints, by their
  // paths.
  std::map<std::string, std::string> inputs;
  std::map<std::string, std::string> options;  // as they are typed, by name
  std::vector<RefinementTile> tiles;
  uint64_t identity = 0;  // of all these but the tiles

  uint32_t NumColors() const;

  // The tiles of lower colours than `color`, by colour, then by number.
  std::vector<uint32_t> TilesBefore(uint32_t color) const;
  std::vector<uint32_t> TilesOf(uint32_t color) const;
};

std::filesystem::path RefinementPlanPath(const std::filesystem::path& folder);

uint64_t IdentityOf(const RefinementPlan& plan);

// \throw FileError if it can not be written
void WriteRefinementPlan(const std::filesystem::path& folder,
                         const RefinementPlan& plan);

// \param plan  whose mesh is refined
// \throw FileError if there is none, or it is damaged, or of another version or
//        of another plan
RefinementPlan ReadRefinementPlan(const std::filesystem::path& folder,
                                  const Plan& plan);

// \throw FileError if a file is not as it was when the refinement was planned.
//        One that is not there, or was not planned with, is not missed.
void ExpectSameInput(const RefinementPlan& plan,
                     const std::filesystem::path& path);

// Sets the options that the result depends on.
// \throw FileError if one is not known
void ApplyOptions(const std::filesystem::path& folder,
                  const RefinementPlan& plan, RefinerOptions* options);

}  // namespace colmap_ext
