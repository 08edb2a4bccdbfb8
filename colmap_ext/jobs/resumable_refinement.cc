#include "colmap_ext/jobs/resumable_refinement.h"

#include <unistd.h>

#include <utility>

#include <fmt/format.h>

#include "colmap_ext/jobs/refinement_backend.h"
#include "colmap_ext/jobs/refinement_state.h"
#include "colmap_ext/report/refinement_report.h"
#include "colmap_ext/terminal/stop_signal.h"
#include "formats/write_mesh.h"
#include "refine/facet_sizes.h"

namespace colmap_ext {

namespace fs = std::filesystem;

ResumableRefinement::ResumableRefinement(const RefinerOptions& options,
                                         fs::path output, LiveView* live)
    : options_(options),
      output_(std::move(output)),
      live_(live),
      reporter_(std::cout, isatty(STDOUT_FILENO) != 0),
      progress_(reporter_.AsProgress()) {}

void ResumableRefinement::Resume(RefinementInput* input) {
  RefinementState state = ReadState(output_, inputs, input->views);
  level_ = state.level;
  input->mesh = std::move(state.mesh);
  input->attributes = std::move(state.attributes);
  input->views = std::move(state.views);
  input->fixed_sources = std::move(state.fixed_sources);
  input->origins = std::move(state.origins);
  earlier_ = std::move(state.report);
  PrintText("goes on after",
            LevelName(level_) + ", by " + StatePath(output_).string(), &log_);
}

RefinedMesh ResumableRefinement::Run(RefinementInput* input) {
  is_part_ = input->is_part;
  const RefinementBackend backend =
      MakeBackend(options_, input->images,
                  ExpectedFacets(options_.refinement.max_face_area, input->mesh,
                                 input->attributes.views, input->views),
                  [this](const std::string& warning) {
                    reporter_.Finish();
                    PrintWarning(warning, &log_);
                  });
  PrintText("computed by", backend.description, &log_);
  std::cout << std::endl;
  const StopSignal stop_signal;
  RefinementHooks hooks;
  hooks.progress = progress_;
  hooks.on_step = [this](const RefinementStep& step, const RefinedMesh& state) {
    OnStep(step, state);
  };
  hooks.on_cameras = [this](const CameraRefinementReport& report) {
    reporter_.Note(Describe(report));
  };
  hooks.on_level = [this](int level, const RefinedMesh& state) {
    OnLevel(level, state);
  };
  hooks.should_stop = [this] {
    const auto is_interrupted = [] { return StopSignal::Received() != 0; };
    if (live_ != nullptr) {
      live_->WaitWhilePaused(is_interrupted);
    }
    return is_interrupted();
  };
  FacetwiseRefinementOptions method = options_.refinement;
  method.cameras.parts = input->camera_parts;
  method.region = input->region;
  RefinedMesh refined = RefineFacetwise(
      method,
      {{std::move(input->mesh), std::move(input->attributes),
        std::move(input->origins), std::move(input->fixed_sources)},
       (level_ > 0 ? level_ : method.levels) - 1,
       input->has_fused_points,
       input->cameras,
       earlier_.misalignment,
       input->is_part},
      input->views, input->points, backend.energy.get(), hooks);
  signal_ = StopSignal::Received();
  refined.report = WithEarlier(std::move(refined.report));
  return refined;
}

void ResumableRefinement::OnStep(const RefinementStep& step,
                                 const RefinedMesh& state) {
  reporter_.Note(Describe(step));
  if (live_ != nullptr) {
    live_->Show(state.mesh, state.attributes, Describe(step));
  }
  if (options_.snapshot_interval > 0 && step.iteration > 0 &&
      step.iteration % options_.snapshot_interval == 0) {
    WriteColoredMesh(fs::path(output_).replace_extension(
                         fmt::format(".{}.{}.ply", step.level, step.iteration)),
                     state.mesh, state.attributes.colors);
  }
}

void ResumableRefinement::OnLevel(int level, const RefinedMesh& state) {
  if (level == 0) {
    return;
  }
  if (!is_part_) {
    WriteMesh(LevelMeshPath(level), state.mesh, state.attributes);
  }
  WriteState(output_, inputs,
             {level, state.mesh, state.attributes, state.origins,
              state.fixed_sources, state.views, WithEarlier(state.report)});
  RemoveLevelMeshes(level + 1);
  level_ = level;
}

// A report of this run, with what an interrupted one did before it.
RefinementReport ResumableRefinement::WithEarlier(
    RefinementReport report) const {
  const double seconds =
      earlier_.steps.empty() ? 0 : earlier_.steps.back().seconds;
  for (RefinementStep& step : report.steps) {
    step.seconds += seconds;
  }
  report.steps.insert(report.steps.begin(), earlier_.steps.begin(),
                      earlier_.steps.end());
  report.labelings.insert(report.labelings.begin(), earlier_.labelings.begin(),
                          earlier_.labelings.end());
  report.num_shortened_steps += earlier_.num_shortened_steps;
  report.num_unconverged_solutions += earlier_.num_unconverged_solutions;
  report.num_flipped_facets += earlier_.num_flipped_facets;
  report.num_removed_self_intersections +=
      earlier_.num_removed_self_intersections;
  return report;
}

fs::path ResumableRefinement::LevelMeshPath(int level) const {
  return fs::path(output_).replace_extension(
      fmt::format(".level{}.ply", level));
}

// Of this level and those before.
void ResumableRefinement::RemoveLevelMeshes(int level) const {
  for (; !is_part_ && level < options_.refinement.levels; ++level) {
    std::error_code ignored;
    fs::remove(LevelMeshPath(level), ignored);
    fs::remove(VisibilityPath(LevelMeshPath(level)), ignored);
  }
}

void ResumableRefinement::RemoveFiles() const {
  if (level_ > 0) {
    RemoveState(output_);
    RemoveLevelMeshes(1);
  }
}

}  // namespace colmap_ext
