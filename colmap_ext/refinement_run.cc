#include "colmap_ext/refinement_run.h"

#include <unistd.h>

#include <filesystem>
#include <iostream>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "colmap_ext/colmap_compat.h"
#include "colmap_ext/errors.h"
#include "colmap_ext/jobs/refinable_cameras.h"
#include "colmap_ext/jobs/refinement_backend.h"
#include "colmap_ext/jobs/refinement_state.h"
#include "colmap_ext/report/page_pictures.h"
#include "colmap_ext/report/print_lines.h"
#include "colmap_ext/report/print_report.h"
#include "colmap_ext/report/refinement_report.h"
#include "colmap_ext/run_command.h"
#include "colmap_ext/terminal/progress_reporter.h"
#include "colmap_ext/terminal/stop_signal.h"
#include "colmap_ext/write_labels.h"
#include "formats/atomic_file.h"
#include "formats/write_mesh.h"
#include "mesh/mesh_in_image.h"
#include "mesh/topology.h"
#include "refine/facet_sizes.h"
#include "refine/facetwise_refinement.h"
#include "workspace/expect_outputs.h"
#include "workspace/write_sparse_model.h"

namespace colmap_ext {

namespace {

namespace fs = std::filesystem;

// What brings poses closer that are too inaccurate.
std::string HowToAlign(const RefinementInput& input) {
  if (HasOneImageFrames(input.sparse_model)) {
    return "Let --FacetwiseRefinement.refine_cameras poses align them";
  }
  return fmt::format(
      "Cameras of rigs are not refined here: refine them by `mkdir SPARSE && "
      "colmap bundle_adjuster --input_path {} --output_path SPARSE`, and take "
      "--sparse_path SPARSE",
      input.workspace.sparse_path.string());
}

// One run of the command, from its files to its files.
class Refiner {
 public:
  // \param live  shows the run, or nullptr.
  Refiner(const RefinerOptions& options, const RefinementPaths& paths,
          std::vector<PageOption> page_options, LiveView* live)
      : options_(options),
        paths_(paths),
        page_options_(std::move(page_options)),
        live_(live),
        reporter_(std::cout, isatty(STDOUT_FILENO) != 0),
        progress_([this](std::string_view stage, double share) {
          reporter_.Update(stage, share);
        }) {}

  void Run() {
    Read();
    RefinedMesh refined = Refine();
    if (refined.report.is_stopped) {
      GiveUp(refined.report);
    }
    AtomicFiles files;
    Write(refined, &files);
    const PagePictures pictures = Draw(refined);
    reporter_.Finish();
    Print(refined);
    WritePage(refined.report.steps, pictures, &files);
    Commit(refined, &files);
    PrintFiles(refined.report);
  }

 private:
  void Read() {
    input_ = ReadRefinementInput(options_, paths_, decoder_, progress_);
    Report(progress_, "Fingerprinting the files", 0);
    inputs_ = RunInputs(options_, paths_, input_);
    if (HasReport()) {
      before_ = input_.mesh;
    }
    level_ = options_.refinement.levels;
    if (options_.resume && fs::exists(StatePath(paths_.output))) {
      RefinementState state = ReadState(paths_.output, inputs_, input_.views);
      level_ = state.level;
      input_.mesh = std::move(state.mesh);
      input_.attributes = std::move(state.attributes);
      origins_ = std::move(state.origins);
      input_.views = std::move(state.views);
      earlier_ = std::move(state.report);
      is_state_ours_ = true;
    }
    reporter_.Finish();
    PrintReport(input_, &log_);
    PrintStart();
    if (live_ != nullptr) {
      live_->Start(input_.mesh, input_.attributes, input_.views, input_.points);
    }
  }

  void PrintStart() {
    const std::string state_path = StatePath(paths_.output).string();
    if (is_state_ours_) {
      PrintText("goes on after", LevelName(level_) + ", by " + state_path,
                &log_);
    } else if (options_.resume) {
      PrintText("starts from the beginning", "there is no " + state_path,
                &log_);
    } else if (fs::exists(state_path)) {
      PrintText("starts from the beginning",
                "--resume 1 would go on by " + state_path, &log_);
    }
  }

  RefinedMesh Refine() {
    const RefinementBackend backend = MakeBackend(
        options_, input_.images,
        ExpectedFacets(options_.refinement.max_face_area, input_.mesh,
                       input_.attributes.views, input_.views),
        [this](const std::string& warning) {
          reporter_.Finish();
          PrintWarning(warning, &log_);
        });
    PrintText("computed by", backend.description, &log_);
    std::cout << std::endl;
    const StopSignal stop_signal;
    RefinementHooks hooks;
    hooks.progress = progress_;
    hooks.on_step = [this](const RefinementStep& step,
                           const RefinedMesh& state) { OnStep(step, state); };
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
    method.cameras.parts = input_.camera_parts;
    method.region = input_.region;
    RefinedMesh refined = RefineFacetwise(
        method,
        {{std::move(input_.mesh), std::move(input_.attributes),
          std::move(origins_)},
         level_ - 1,
         input_.has_fused_points,
         input_.cameras,
         earlier_.misalignment},
        input_.views, input_.points, backend.energy.get(), hooks);
    signal_ = StopSignal::Received();
    refined.report = WithEarlier(std::move(refined.report));
    return refined;
  }

  void OnStep(const RefinementStep& step, const RefinedMesh& state) {
    reporter_.Note(Describe(step));
    if (live_ != nullptr) {
      live_->Show(state.mesh, state.attributes, Describe(step));
    }
    if (options_.snapshot_interval > 0 && step.iteration > 0 &&
        step.iteration % options_.snapshot_interval == 0) {
      WriteColoredMesh(fs::path(paths_.output)
                           .replace_extension(fmt::format(
                               ".{}.{}.ply", step.level, step.iteration)),
                       state.mesh, state.attributes.colors);
    }
  }

  void OnLevel(int level, const RefinedMesh& state) {
    if (level > 0) {
      // For users: not needed to resume.
      WriteMesh(LevelMeshPath(level), state.mesh, state.attributes);
      WriteState(paths_.output, inputs_,
                 {level, state.mesh, state.attributes, state.origins,
                  state.fixed_sources, state.views, WithEarlier(state.report)});
      RemoveLevelMeshes(level + 1);
      is_state_ours_ = true;
      level_ = level;
    }
  }

  // The mesh of a level that is complete.
  fs::path LevelMeshPath(int level) const {
    return fs::path(paths_.output)
        .replace_extension(fmt::format(".level{}.ply", level));
  }

  // Of this level and those before.
  void RemoveLevelMeshes(int level) const {
    for (; level < options_.refinement.levels; ++level) {
      std::error_code ignored;
      fs::remove(LevelMeshPath(level), ignored);
      fs::remove(VisibilityPath(LevelMeshPath(level)), ignored);
    }
  }

  // A report of this run, with what an interrupted one did before it.
  RefinementReport WithEarlier(RefinementReport report) const {
    const double seconds =
        earlier_.steps.empty() ? 0 : earlier_.steps.back().seconds;
    for (RefinementStep& step : report.steps) {
      step.seconds += seconds;
    }
    report.steps.insert(report.steps.begin(), earlier_.steps.begin(),
                        earlier_.steps.end());
    report.labelings.insert(report.labelings.begin(),
                            earlier_.labelings.begin(),
                            earlier_.labelings.end());
    report.num_shortened_steps += earlier_.num_shortened_steps;
    report.num_unconverged_solutions += earlier_.num_unconverged_solutions;
    report.num_flipped_facets += earlier_.num_flipped_facets;
    report.num_removed_self_intersections +=
        earlier_.num_removed_self_intersections;
    return report;
  }

  [[noreturn]] void GiveUp(const RefinementReport& report) {
    reporter_.Finish();
    AtomicFiles files;
    WriteReport(report, &files);
    files.Commit();
    if (!is_state_ours_) {
      throw Interruption(signal_,
                         "no level was complete, and nothing was written");
    }
    throw Interruption(signal_, "the mesh refined up to " + LevelName(level_) +
                                    " is " + LevelMeshPath(level_).string() +
                                    "; --resume 1 goes on from it");
  }

  void Write(const RefinedMesh& refined, AtomicFiles* files) {
    Report(progress_, "Writing the mesh", 0);
    ExpectManifold(refined.mesh);
    if (live_ != nullptr) {
      live_->Show(refined.mesh, refined.attributes, "writing");
    }
    WriteMesh(paths_.output, refined.mesh, refined.attributes,
              options_.scene.transform, files);
    WriteFoundRegion(options_.scene.region, input_.region, paths_.output,
                     files);
    WriteReport(refined.report, files);
    if (!options_.labels_path.empty()) {
      Report(progress_, "Drawing the labels", 0);
      WriteLabels(options_.labels_path, options_.LabelsPicturePath(),
                  refined.mesh, refined.labels, refined.views, files);
    }
  }

  // All files or none: the cameras, a folder, where the others are on the disk
  // and have only to get their names.
  void Commit(const RefinedMesh& refined, AtomicFiles* files) {
    files->Sync();
    if (AreCamerasRefined(refined.report)) {
      WriteSparseModel(
          paths_.refined_sparse,
          WithRefinedCameras(
              std::move(input_.sparse_model),
              input_.workspace.order.order.images, refined.views,
              input_.camera_parts == RefinedParts::kPosesIntrinsics,
              refined.track_positions));
    }
    files->Commit();
    if (is_state_ours_) {
      RemoveState(paths_.output);
      RemoveLevelMeshes(1);
    }
  }

  // Whether other cameras than the input's belong to the mesh.
  static bool AreCamerasRefined(const RefinementReport& report) {
    return !report.cameras.empty();
  }

  bool HasReport() const { return !options_.report_path.empty(); }

  void WriteReport(const RefinementReport& report, AtomicFiles* files) const {
    if (HasReport()) {
      WriteText(options_.StepsPath(), StepsCsv(report.steps), files);
      WriteText(options_.PlotPath(), StepsPlot(report.steps), files);
    }
  }

  PagePictures Draw(const RefinedMesh& refined) const {
    if (!HasReport()) {
      return {};
    }
    Report(progress_, "Drawing the report", 0);
    const PageCameras cameras =
        ChoosePageCameras(refined.views, refined.attributes.views,
                          paths_.folder / "images", decoder_);
    return DrawRefinement(cameras, before_, refined);
  }

  void WritePage(const std::vector<RefinementStep>& steps,
                 const PagePictures& pictures, AtomicFiles* files) const {
    if (HasReport()) {
      WriteText(options_.PagePath(),
                RefinementPage({"facetwise_refiner", paths_.output.string(),
                                Versions(), page_options_},
                               log_, steps, pictures),
                files);
    }
  }

  void Print(const RefinedMesh& refined) {
    PrintReport(refined.report, Analyze(refined.mesh), &log_);
    PrintFootprint(
        MedianFootprint(refined.mesh, refined.attributes.views, refined.views),
        &log_);
    if (refined.report.is_skipped) {
      PrintWarning(
          fmt::format("the camera poses are too inaccurate ({:.2f} px): the "
                      "mesh was not refined, and is written as it is. {}",
                      refined.report.misalignment->by_cameras,
                      HowToAlign(input_)),
          &log_);
    }
    if (refined.report.misalignment) {
      PrintReport(*refined.report.misalignment, refined.views, &log_);
    }
    if (AreCamerasRefined(refined.report)) {
      PrintReport(refined.report.cameras.back(), refined.views, &log_);
    } else {
      PrintSameCameras();
    }
    PrintReport(reporter_.StageTimes(), PeakMemory(), &log_);
  }

  // Cameras of an earlier run may lie where those of this one would.
  void PrintSameCameras() {
    std::error_code ignored;
    const fs::path& sparse = input_.workspace.sparse_path;
    PrintText("cameras", "as they were, " + sparse.string(), &log_);
    if (fs::exists(paths_.refined_sparse, ignored) &&
        !fs::equivalent(paths_.refined_sparse, sparse, ignored)) {
      PrintWarning(paths_.refined_sparse.string() +
                       " is of an earlier run: this mesh does not belong to it",
                   &log_);
    }
  }

  void PrintFiles(const RefinementReport& report) const {
    std::cout << "\nWrote " << paths_.output.string()
              << (AreCamerasRefined(report) ? ", " : " and ")
              << VisibilityPath(paths_.output).string();
    if (AreCamerasRefined(report)) {
      std::cout << " and " << paths_.refined_sparse.string()
                << ", which belong together";
    }
    std::cout << std::endl;
  }

  const RefinerOptions& options_;
  const RefinementPaths& paths_;
  const std::vector<PageOption> page_options_;
  LiveView* live_;
  const PictureDecoder decoder_ = ColmapPictureDecoder();
  ProgressReporter reporter_;
  Progress progress_;
  ReportLog log_{&std::cout};
  RefinementInput input_;
  TriangleMesh before_;  // the input's, if it is reported on
  JobInputs inputs_;
  RefinementReport earlier_;              // of the run that is gone on with
  std::vector<Eigen::Vector3f> origins_;  // see RefinementStart
  int level_ = 0;  // the last complete one; above all before the first
  bool is_state_ours_ = false;  // the state on the disk is that of level_
  int signal_ = 0;
};

}  // namespace

void CheckOutputs(const RefinerOptions& options, const RefinementPaths& paths) {
  const fs::path& output = paths.output;
  std::vector<fs::path> outputs = {output, VisibilityPath(output),
                                   StatePath(output)};
  if (options.refinement.cameras.parts != RefinedParts::kNothing) {
    std::error_code ignored;
    ExpectWritable(fs::is_directory(paths.refined_sparse, ignored)
                       ? paths.refined_sparse / "images.bin"
                       : paths.refined_sparse);
  }
  if (options.scene.region.is_auto) {
    outputs.push_back(RegionPath(output));
  }
  if (!options.report_path.empty()) {
    outputs.insert(outputs.end(), {options.StepsPath(), options.PlotPath(),
                                   options.PagePath()});
  }
  if (!options.labels_path.empty()) {
    outputs.insert(outputs.end(),
                   {options.labels_path, options.LabelsPicturePath()});
  }
  std::vector<fs::path> inputs =
      WorkspaceInputs(paths.folder, paths.fused, options.sparse_path);
  inputs.insert(
      inputs.end(),
      {paths.mesh, VisibilityPath(paths.mesh), options.scene.mask_path,
       options.scene.transform_path, options.scene.region.text});
  ExpectOutputs(outputs, inputs);
}

void RunRefinement(const RefinerOptions& options, const RefinementPaths& paths,
                   const std::vector<PageOption>& page_options,
                   LiveView* live) {
  Refiner(options, paths, page_options, live).Run();
}

}  // namespace colmap_ext
