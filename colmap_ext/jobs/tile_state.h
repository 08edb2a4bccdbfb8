#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "colmap_ext/jobs/job_inputs.h"
#include "colmap_ext/jobs/refinement_job.h"
#include "colmap_ext/jobs/refinement_state.h"
#include "refine/facetwise_refinement.h"

namespace colmap_ext {

// The state of a tile's job after a complete level, on disk beside its patch in
// the files of an ordinary refinement (refinement_state.h), so that an
// interrupted job can be resumed.
class TileState {
 public:
  // \param picture_errors [views] empty: the picture can be used
  TileState(const RefinementJob& job, const SurfacePart& part,
            const std::vector<std::string>& picture_errors);

  // Sets the start to the stored state. A state that is damaged or of another
  // run is ignored: the job starts from its first level then.
  // \param views  that the job compares
  // \return the level after which it resumes, or 0: from the start
  int GoOn(const std::vector<View>& views, RefinementStart* start);

  // Writes a level that is complete.
  // \param state  as RefinementHooks::on_level gets it
  // \throw FileError if it can not be written
  void Write(int level, const RefinedMesh& state) const;

 private:
  std::filesystem::path output_;
  JobInputs inputs_;
};

}  // namespace colmap_ext
