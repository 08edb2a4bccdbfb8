#include "colmap_ext/jobs/resumable_refinement.h"

#include <algorithm>
#include <sstream>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "formats/write_mesh.h"
#include "gl/egl_context.h"
#include "gl/gl_photometric_energy.h"

namespace colmap_ext {
namespace {

namespace fs = std::filesystem;

// By options.backend. Where the choice is free, OpenGL in software is not
// taken: the processor is faster without it. Where the graphics card fails
// later, the processor takes over.
// \param has_card  see HasGraphicsCard(); false for Backend::kCpu
// \param warn  called with lines for the user, now and as long as the energy
//        lives.
// \throw OptionError if OpenGL is asked for, and is not to be had.
std::unique_ptr<PhotometricEnergy> MakeEnergy(
    const RefinerOptions& options, const RefinementInput& input, bool has_card,
    const std::function<void(const std::string&)>& warn) {
  const FacetLabelingOptions& labeling = options.refinement.labeling;
  const bool is_wanted = options.backend == Backend::kGl;
  try {
    if (is_wanted || has_card) {
      auto energy = MakeGlPhotometricEnergy(
          options.refinement.photometric, input.images,
          {options.gpu_index,
           input.MaxDrawingMemory(),
           {},
           static_cast<size_t>(input.expected.facets),
           // Both directions of the first labels, one of the final ones.
           static_cast<size_t>(std::max(2 * labeling.pairs_per_facet,
                                        labeling.final_pairs_per_facet)),
           warn});
      if (!has_card) {
        warn(
            "OpenGL is drawn by software here, which is slower than "
            "--FacetwiseRefinement.backend cpu");
      }
      return energy;
    }
  } catch (const GlError& error) {
    if (is_wanted) {
      throw OptionError(std::string(error.what()) +
                        "; --FacetwiseRefinement.backend cpu needs none");
    }
    warn(std::string("the graphics card cannot be used (") + error.what() +
         "); the processor computes all");
  }
  return MakeCpuPhotometricEnergy(options.refinement.photometric, input.images,
                                  input.MaxDrawingMemory());
}

JobFile StateFile(const fs::path& output) {
  return {StatePath(output), {"CESTATE3", "start without --resume"}, 0};
}

// Calls function(number) for those of a view that the refinement changes.
template <typename AnyView, typename Function>
void ForEachCameraNumber(AnyView* view, const Function& function) {
  for (auto* number : {&view->fx, &view->fy, &view->cx, &view->cy}) {
    function(*number);
  }
  for (auto& number : view->cam_from_world_rotation.reshaped()) {
    function(number);
  }
  for (auto& number : view->cam_from_world_translation) {
    function(number);
  }
}

// Names and values, each with a null character behind it.
std::vector<char> ValuesText(const JobInputs::Values& values) {
  std::vector<char> text;
  for (const auto& [name, value] : values) {
    text.insert(text.end(), name.c_str(), name.c_str() + name.size() + 1);
    text.insert(text.end(), value.c_str(), value.c_str() + value.size() + 1);
  }
  return text;
}

JobInputs::Values ValuesFrom(const std::vector<char>& text) {
  JobInputs::Values values;
  std::istringstream stream(std::string(text.begin(), text.end()));
  for (std::string name, value;
       std::getline(stream, name, '\0') && std::getline(stream, value, '\0');) {
    values[name] = value;
  }
  return values;
}

}  // namespace

fs::path StatePath(const fs::path& output) {
  return output.string() + ".resume";
}

void ExpectManifold(const TriangleMesh& mesh) {
  if (const MeshReport report = Analyze(mesh); !report.IsManifold()) {
    throw std::logic_error("the refined mesh has " + report.Defects());
  }
}

void WriteState(const fs::path& output, const JobInputs& inputs, int level,
                const RefinedMesh& state, const RefinementReport& report) {
  ExpectManifold(state.mesh);
  const CameraAlignment& alignment = state.alignment;
  const Misalignment& misalignment = alignment.misalignment;
  const CameraRefinementReport refined = alignment.IsRefined()
                                             ? alignment.refinements.back()
                                             : CameraRefinementReport();
  const VertexAttributes& attributes = state.attributes;
  std::vector<double> cameras;
  for (const View& view : state.views) {
    ForEachCameraNumber(&view,
                        [&](double number) { cameras.push_back(number); });
  }
  WriteJobFile(
      StateFile(output), ValuesText(inputs.options), ValuesText(inputs.files),
      level, state.mesh.vertices, state.mesh.facets, attributes.colors,
      attributes.views, attributes.confidences, state.origins,
      state.fixed_sources, cameras, misalignment.by_cameras,
      misalignment.of_surface, misalignment.by_view, misalignment.radial_shifts,
      alignment.track_positions, refined.track_sigma, refined.views,
      report.num_removed_self_intersections, report.labelings, report.steps);
}

int ReadState(const fs::path& output, const JobInputs& inputs,
              RefinedMesh* state) {
  const JobFile state_file = StateFile(output);
  const JobFileReader file(state_file);
  const JobInputs earlier = {ValuesFrom(file.ReadAll<char>(0)),
                             ValuesFrom(file.ReadAll<char>(1))};
  if (const std::string difference = inputs.DifferenceTo(earlier);
      !difference.empty()) {
    throw FileError(state_file.path, "belongs to another run: " + difference +
                                         "; go on as it was begun, or " +
                                         state_file.kind.what_to_do);
  }
  int level = 0;
  std::vector<double> cameras;
  Misalignment& misalignment = state->alignment.misalignment;
  CameraRefinementReport refined;
  VertexAttributes& attributes = state->attributes;
  RefinementReport& report = state->report;
  file.ReadFrom(2, &level, &state->mesh.vertices, &state->mesh.facets,
                &attributes.colors, &attributes.views, &attributes.confidences,
                &state->origins, &state->fixed_sources, &cameras,
                &misalignment.by_cameras, &misalignment.of_surface,
                &misalignment.by_view, &misalignment.radial_shifts,
                &state->alignment.track_positions, &refined.track_sigma,
                &refined.views, &report.num_removed_self_intersections,
                &report.labelings, &report.steps);
  if (!refined.views.empty()) {
    state->alignment.refinements = {std::move(refined)};
  }
  size_t next = 0;
  for (View& view : state->views) {
    ForEachCameraNumber(&view,
                        [&](double& number) { number = cameras.at(next++); });
  }
  return level;
}

void RemoveState(const fs::path& output) {
  std::error_code ignored;
  fs::remove(StatePath(output), ignored);
}

ResumableRefinement::ResumableRefinement(const RefinerOptions& options,
                                         fs::path output, Console* console,
                                         LiveView* live)
    : options_(options),
      output_(std::move(output)),
      live_(live),
      console_(*console) {}

void ResumableRefinement::Resume(RefinementInput* input) {
  RefinedMesh state;
  state.views = input->views;
  level_ = ReadState(output_, inputs, &state);
  input->views = std::move(state.views);
  earlier_ = std::move(state.report);
  alignment_ = std::move(state.alignment);
  Surface& surface = *input;
  surface = std::move(state);
}

RefinedMesh ResumableRefinement::Run(RefinementInput* input) {
  const bool has_card =
      options_.backend != Backend::kCpu && HasGraphicsCard(options_.gpu_index);
  const std::unique_ptr<PhotometricEnergy> energy = MakeEnergy(
      options_, *input, has_card, [this](const std::string& warning) {
        console_.reporter.Finish();
        PrintWarning(warning, &console_.log);
      });
  PrintText(
      "computed by",
      energy->Description() + (options_.backend == Backend::kAuto && !has_card
                                   ? "; there is no graphics card with OpenGL"
                                   : ""),
      &console_.log);
  std::cout << std::endl;
  const StopSignal stop_signal;
  RefinementHooks hooks;
  hooks.progress = console_.progress;
  hooks.on_step = [this](const RefinementStep& step, const RefinedMesh& state) {
    OnStep(step, state);
  };
  hooks.on_cameras = [this](const CameraRefinementReport& report) {
    console_.reporter.Note(Describe(report));
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
  method.region = input->region;
  Surface& surface = *input;
  RefinedMesh refined = RefineFacetwise(
      method,
      {std::move(surface), (level_ > 0 ? level_ : method.levels) - 1,
       input->has_fused_points, std::move(input->cameras), alignment_,
       input->is_part},
      input->views, input->points, energy.get(), hooks);
  signal_ = StopSignal::Received();
  refined.report = WithEarlier(std::move(refined.report));
  return refined;
}

void ResumableRefinement::OnStep(const RefinementStep& step,
                                 const RefinedMesh& state) {
  console_.reporter.Note(Describe(step));
  if (live_ != nullptr) {
    live_->Show(state.mesh, state.attributes, Describe(step));
  }
}

void ResumableRefinement::OnLevel(int level, const RefinedMesh& state) {
  if (level == 0) {
    return;
  }
  WriteState(output_, inputs, level, state, WithEarlier(state.report));
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
  report.num_removed_self_intersections +=
      earlier_.num_removed_self_intersections;
  return report;
}

fs::path ResumableRefinement::LevelMeshPath(int level) const {
  return fs::path(output_).replace_extension(
      fmt::format(".level{}.ply", level));
}

void ResumableRefinement::RemoveFiles() const {
  RemoveState(output_);
  for (int level = 1; level < options_.refinement.levels; ++level) {
    std::error_code ignored;
    fs::remove(LevelMeshPath(level), ignored);
    fs::remove(VisibilityPath(LevelMeshPath(level)), ignored);
  }
}

}  // namespace colmap_ext
