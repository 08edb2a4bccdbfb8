#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "colmap_ext/refinement/run_identity.h"
#include "colmap_ext/tiling/refinement_job.h"
#include "refine/facetwise_refinement.h"

namespace colmap_ext {

// What a tile's job has refined up to a level, on disk beside its patch as the
// refiner without tiles leaves it (refinement_state.h), so that a job that was
// ended goes on from there.
class TileState {
 public:
  // \param picture_errors [views] empty: the picture can be used
  TileState(const RefinementJob& job, const SurfacePart& part,
            const std::vector<std::string>& picture_errors);

  // Changes the start to what is there. One that is damaged, or left by another
  // run, is as none: the job starts from its first level then.
  // \param views  that the job compares
  // \return the level after which it goes on, or 0: from the start
  int GoOn(const std::vector<View>& views, RefinementStart* start);

  // Writes a level that is complete.
  // \param state  as RefinementHooks::on_level gets it
  // \throw FileError if it can not be written
  void Write(int level, const RefinedMesh& state) const;

  // \return [V] the vertex of the part, of those that stay
  FixedSources SourcesInPart(const FixedSources& sources) const;

 private:
  std::filesystem::path output_;
  RunIdentity identity_;
  FixedSources before_;  // [V] of the start, in the part; empty: the same
};

// Removes what is there of a tile.
// \param num_levels  of the refinement
void RemoveTileState(const std::filesystem::path& folder, uint32_t tile,
                     int num_levels);

}  // namespace colmap_ext
