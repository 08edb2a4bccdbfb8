#pragma once

#include <filesystem>
#include <iostream>
#include <string>
#include <string_view>
#include <vector>

#include "colmap_ext/jobs/job_inputs.h"
#include "colmap_ext/jobs/refinement_input.h"
#include "colmap_ext/report/print_lines.h"
#include "colmap_ext/terminal/progress_reporter.h"
#include "colmap_ext/viewing/live_view.h"

namespace colmap_ext {

// A refinement that can be interrupted: of a whole mesh or, if vertices around
// it are fixed, of the tile of a plan. Prints its iterations, stops at a
// signal, and keeps its state after each complete level (refinement_state.h).
class ResumableRefinement {
 public:
  // \param options  finished; they and the view have to outlive this
  // \param output  beside which the state lies
  // \param live  shows the run, or nullptr.
  ResumableRefinement(const RefinerOptions& options,
                      std::filesystem::path output, LiveView* live);

  // Continues a run of the same inputs: sets the input to its last complete
  // level.
  // \throw FileError as ReadState()
  void Resume(RefinementInput* input);

  // \param input  mesh, attributes and fixed vertices are moved
  RefinedMesh Run(RefinementInput* input);

  // Of an interruption, if the refinement was stopped.
  int Signal() const { return signal_; }

  // The last complete level on disk; 0: none.
  int Level() const { return level_; }

  // The mesh of a complete level that is kept for users, unless this is a tile.
  std::filesystem::path LevelMeshPath(int level) const;

  // To be called when the result is written.
  void RemoveFiles() const;

  const Progress& GetProgress() const { return progress_; }
  ProgressReporter* Reporter() { return &reporter_; }
  ReportLog* Log() { return &log_; }

  // What the result depends on, to be set before it runs.
  JobInputs inputs;

 private:
  void OnStep(const RefinementStep& step, const RefinedMesh& state);
  void OnLevel(int level, const RefinedMesh& state);
  RefinementReport WithEarlier(RefinementReport report) const;
  void RemoveLevelMeshes(int level) const;

  const RefinerOptions& options_;
  const std::filesystem::path output_;
  LiveView* live_;
  ProgressReporter reporter_;
  Progress progress_;
  ReportLog log_{&std::cout};
  bool is_part_ = false;
  int level_ = 0;
  int signal_ = 0;
  RefinementReport earlier_;  // of the run that is resumed
};

}  // namespace colmap_ext
