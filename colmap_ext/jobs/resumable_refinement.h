#pragma once

#include <filesystem>
#include <optional>

#include "colmap_ext/jobs/job_file.h"
#include "colmap_ext/jobs/refinement_input.h"
#include "colmap_ext/report/print_report.h"
#include "colmap_ext/viewing/live_view.h"
#include "mesh/triangle_mesh.h"
#include "refine/facetwise_refinement.h"

namespace colmap_ext {

// OUTPUT.resume: the state after a complete level, from which an interrupted
// refinement is resumed.
std::filesystem::path StatePath(const std::filesystem::path& output);

// \param level  the last one that is complete, 1 or more.
// \param report  of this run and those before it: steps, labelings and counts
//        are written.
// \throw FileError if it cannot be written; std::logic_error if the mesh is
//        not manifold.
void WriteState(const std::filesystem::path& output, const JobInputs& inputs,
                int level, const RefinedMesh& state,
                const RefinementReport& report);

// Reads what WriteState() wrote.
// \param state  [in] the views before they were refined.
// \return the level.
// \throw FileError if there is no state, it is damaged, or belongs to another
//        run: the message names the difference.
int ReadState(const std::filesystem::path& output, const JobInputs& inputs,
              RefinedMesh* state);

void RemoveState(const std::filesystem::path& output);

// \throw std::logic_error if it is not manifold.
void ExpectManifold(const TriangleMesh& mesh);

// A refinement that can be interrupted: of a whole mesh or, if vertices around
// it are fixed, of the tile of a plan. Prints its iterations, stops at a
// signal, and keeps its state after each complete level.
class ResumableRefinement {
 public:
  // \param options  finished; these, console and view have to outlive this
  // \param output  beside which the state lies
  // \param live  shows the run, or nullptr.
  ResumableRefinement(const RefinerOptions& options,
                      std::filesystem::path output, Console* console,
                      LiveView* live);

  // Sets the input to the last complete level on disk, of this run or of an
  // earlier one of the same inputs, which is continued then.
  // \throw FileError as ReadState()
  void Resume(RefinementInput* input);

  // \param input  mesh, attributes and fixed vertices are moved
  RefinedMesh Run(RefinementInput* input);

  // Of an interruption, if the refinement was stopped.
  int Signal() const { return signal_; }

  // The last complete level on disk; 0: none.
  int Level() const { return level_; }

  // Where an interrupted run leaves the mesh of its last complete level.
  std::filesystem::path LevelMeshPath(int level) const;

  // To be called when the result is written.
  void RemoveFiles() const;

  // What the result depends on, to be set before it runs.
  JobInputs inputs;

 private:
  void OnStep(const RefinementStep& step, const RefinedMesh& state);
  void OnLevel(int level, const RefinedMesh& state);
  RefinementReport WithEarlier(RefinementReport report) const;

  const RefinerOptions& options_;
  const std::filesystem::path output_;
  LiveView* live_;
  Console& console_;
  int level_ = 0;
  int signal_ = 0;
  RefinementReport earlier_;                  // of the run that is resumed
  std::optional<CameraAlignment> alignment_;  // by the run that is resumed
};

}  // namespace colmap_ext
