#include <cmath>
#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <tbb/task_arena.h>

#include "colmap_ext/colmap_compat.h"
#include "colmap_ext/commands.h"
#include "colmap_ext/jobs/refine_tiles.h"
#include "colmap_ext/jobs/refinement_estimate.h"
#include "colmap_ext/jobs/refinement_input.h"
#include "colmap_ext/jobs/resumable_refinement.h"
#include "colmap_ext/options/refinement_options.h"
#include "colmap_ext/report/html_page.h"
#include "colmap_ext/report/print_report.h"
#include "colmap_ext/run_command.h"
#include "colmap_ext/viewing/live_view.h"
#include "formats/atomic_file.h"
#include "formats/write_mesh.h"
#include "mesh/mesh_in_image.h"
#include "mesh/topology.h"
#include "pictures/pictures.h"
#include "viewer/viewer_session.h"
#include "workspace/workspace_paths.h"

namespace colmap_ext {
namespace {

namespace fs = std::filesystem;

// Writes a mesh whose faces are coloured by the pair of views that is best for
// each (formats/write_mesh.h).
void WriteLabels(const fs::path& path, const RefinedMesh& refined,
                 AtomicFiles* together) {
  MeshLabels best{refined.labels.BestLabels(), {}, {}};
  for (const ViewPair& pair : refined.labels.pairs) {
    best.names.push_back(refined.views[pair.first].name + " " +
                         refined.views[pair.second].name);
  }
  for (const int32_t label : best.labels) {
    best.colors.push_back(LabelColor(label));
  }
  WriteLabeledMesh(path, refined.mesh, best, together);
}

// One run of the command, from its files to its files.
class Refiner {
 public:
  // \param live  shows the run, or nullptr.
  Refiner(const RefinerOptions& options, const RefinementPaths& paths,
          Console* console, LiveView* live)
      : options_(options),
        paths_(paths),
        console_(*console),
        live_(live),
        run_(options, paths.output, console, live) {}

  void Run() {
    Read();
    RefinedMesh refined = run_.Run(&input_);
    if (refined.report.is_stopped) {
      GiveUp(refined.report);
    }
    AtomicFiles files;
    Write(refined, &files);
    PagePictures pictures;
    if (HasReport()) {
      Report(progress_, "Drawing the report", 0);
      pictures =
          DrawRefinement(before_, refined, paths_.folder / "images", decoder_);
    }
    console_.reporter.Finish();
    Print(refined);
    WritePage(refined.report.steps, pictures, &files);
    Commit(refined, &files);
    PrintFiles(refined.alignment.IsRefined());
  }

 private:
  void Read() {
    input_ = ReadRefinementInput(options_, paths_, decoder_, progress_);
    Report(progress_, "Fingerprinting the files", 0);
    run_.inputs = RunInputs(options_, paths_, input_);
    if (HasReport()) {
      before_ = input_.mesh;
    }
    console_.reporter.Finish();
    PrintReport(input_, log_);
    PrintEstimate();
    const fs::path state_path = StatePath(paths_.output);
    if (!fs::exists(state_path) && options_.resume) {
      PrintText("starts from the beginning",
                "there is no " + state_path.string(), log_);
    } else if (options_.resume) {
      run_.Resume(&input_);
      PrintText("continues after",
                LevelName(run_.Level()) + ", by " + state_path.string(), log_);
    } else if (fs::exists(state_path)) {
      PrintText("starts from the beginning",
                "--resume 1 would go on by " + state_path.string(), log_);
    }
    if (live_ != nullptr) {
      live_->Start(input_.mesh, input_.attributes, input_.views, input_.points);
    }
  }

  // What the run takes, and how many tiles would do where that is too much.
  void PrintEstimate() {
    const RefinementTile& run = input_.expected;
    const double max_memory_gb = MaxMemoryGb(options_);
    const double memory_gb =
        run.memory_gb + run.thread_gb * tbb::this_task_arena::max_concurrency();
    PrintHeading("Run", log_);
    PrintText("memory, estimated",
              fmt::format("{:.2f} of {:.3g} GB", memory_gb, max_memory_gb),
              log_);
    PrintText("time of all threads, estimated",
              fmt::format("{:.1f} min", run.core_seconds / 60), log_);
    const double disk_gb = kDiskGbPerFacet * run.facets;
    PrintText("disk, estimated", fmt::format("{:.2f} GB", disk_gb), log_);
    const fs::path folder = fs::absolute(paths_.output).parent_path();
    if (1e9 * disk_gb > static_cast<double>(fs::space(folder).available)) {
      PrintWarning("too little space may be left in " + folder.string(), log_);
    }
    const double surface_gb = kUsualGbPerFacet * run.facets;
    const double free_gb = max_memory_gb - (memory_gb - surface_gb);
    if (memory_gb > max_memory_gb) {
      PrintWarning(
          "the run may take more memory than it should; " +
              (free_gb > 0
                   ? fmt::format("tiles have: {} mesh_planner --num_tiles "
                                 "{:.0f}",
                                 ProgramName(),
                                 std::ceil(1.5 * surface_gb / free_gb))
                   : "a smaller --FacetwiseRefinement.image_scale takes less"),
          log_);
    }
  }

  [[noreturn]] void GiveUp(const RefinementReport& report) {
    console_.reporter.Finish();
    const int level = run_.Level();
    AtomicFiles files;
    WriteReport(report, &files);
    if (level > 0) {
      run_.Resume(&input_);
      WriteMesh(run_.LevelMeshPath(level), input_.mesh, input_.attributes,
                std::nullopt, &files);
    }
    files.Commit();
    if (level == 0) {
      throw Interruption(run_.Signal(),
                         "no level was complete, and nothing was written");
    }
    throw Interruption(run_.Signal(), "the mesh refined up to " +
                                          LevelName(level) + " is " +
                                          run_.LevelMeshPath(level).string() +
                                          "; --resume 1 continues from it");
  }

  void Write(const RefinedMesh& refined, AtomicFiles* files) {
    Report(progress_, "Writing the mesh", 0);
    ExpectManifold(refined.mesh);
    if (live_ != nullptr) {
      live_->Show(refined.mesh, refined.attributes, "writing");
    }
    WriteMesh(paths_.output, refined.mesh, refined.attributes,
              options_.scene.transform, files);
    options_.scene.region.WriteFound(input_.region, paths_.output, files);
    WriteReport(refined.report, files);
    if (!options_.labels_path.empty()) {
      WriteLabels(options_.labels_path, refined, files);
    }
  }

  // All files or none: the cameras, a folder, where the others are on the disk
  // and have only to get their names.
  void Commit(const RefinedMesh& refined, AtomicFiles* files) {
    files->Sync();
    if (refined.alignment.IsRefined()) {
      WriteRefinedCameras(paths_.refined_sparse,
                          options_.refinement.cameras.parts,
                          input_.workspace.sparse_path, refined.views,
                          refined.alignment.track_positions);
    }
    files->Commit();
    run_.RemoveFiles();
  }

  bool HasReport() const { return !options_.report_path.empty(); }

  void WriteReport(const RefinementReport& report, AtomicFiles* files) const {
    if (HasReport()) {
      WriteText(options_.StepsPath(), StepsCsv(report.steps), files);
    }
  }

  void WritePage(const std::vector<RefinementStep>& steps,
                 const PagePictures& pictures, AtomicFiles* files) const {
    if (HasReport()) {
      WriteText(options_.PagePath(),
                RefinementPage(
                    {"facetwise_refiner", paths_.output.string(), Versions()},
                    *log_, steps, pictures),
                files);
    }
  }

  void Print(const RefinedMesh& refined) {
    PrintReport(refined.report, Analyze(refined.mesh), log_);
    PrintFootprint(
        MedianFootprint(refined.mesh, refined.attributes.views, refined.views),
        log_);
    if (refined.report.is_skipped) {
      PrintWarning(
          fmt::format("the camera poses are too inaccurate ({:.2f} px): the "
                      "mesh was not refined, and is written unchanged. Let "
                      "--FacetwiseRefinement.refine_cameras poses align them",
                      refined.alignment.misalignment.by_cameras),
          log_);
    }
    PrintReport(refined.alignment, refined.views, log_);
    if (!refined.alignment.IsRefined()) {
      PrintSameCameras();
    }
    console_.PrintTime();
  }

  // Cameras of an earlier run may lie where those of this one would.
  void PrintSameCameras() {
    std::error_code ignored;
    const fs::path& sparse = input_.workspace.sparse_path;
    PrintText("cameras", "unchanged, " + sparse.string(), log_);
    if (fs::exists(paths_.refined_sparse, ignored) &&
        !fs::equivalent(paths_.refined_sparse, sparse, ignored)) {
      PrintWarning(paths_.refined_sparse.string() +
                       " is of an earlier run: this mesh does not belong to it",
                   log_);
    }
  }

  void PrintFiles(bool has_cameras) const {
    std::cout << "\nWrote " << paths_.output.string()
              << (has_cameras ? ", " : " and ")
              << VisibilityPath(paths_.output).string();
    if (has_cameras) {
      std::cout << " and " << paths_.refined_sparse.string()
                << ", which belong together";
    }
    std::cout << std::endl;
  }

  const RefinerOptions& options_;
  const RefinementPaths& paths_;
  Console& console_;
  LiveView* live_;
  const PictureDecoder decoder_ = ColmapPictureDecoder();
  ResumableRefinement run_;
  const Progress& progress_ = console_.progress;
  ReportLog* const log_ = &console_.log;
  RefinementInput input_;
  TriangleMesh before_;  // the input's, if it is reported on
};

// Called before anything is read, so that an unwritable output fails early.
void CheckOutputs(const RefinerOptions& options, const RefinementPaths& paths) {
  const fs::path& output = paths.output;
  if (options.refinement.cameras.parts != RefinedParts::kNothing) {
    std::error_code ignored;
    ExpectWritable(fs::is_directory(paths.refined_sparse, ignored)
                       ? paths.refined_sparse / "images.bin"
                       : paths.refined_sparse);
  }
  ExpectOutputs(
      {output, VisibilityPath(output), StatePath(output),
       options.scene.region.FoundPath(output), options.StepsPath(),
       options.PagePath(), options.labels_path},
      WorkspaceInputs(
          paths.folder, paths.fused, options.sparse_path,
          {paths.mesh, VisibilityPath(paths.mesh), options.scene.mask_path,
           options.scene.transform_path, options.scene.region.text}));
}

void RefineInWindow(const RefinerOptions& options, const RefinementPaths& paths,
                    Console* console) {
  try {
    RunWithViewer("facetwise_refiner " + paths.mesh.string(), paths.folder,
                  ColmapPictureDecoder(), [&](LiveView* live) {
                    Refiner(options, paths, console, live).Run();
                  });
  } catch (const NoWindowError& error) {
    throw OptionError(error.what() +
                      std::string("; leave --viewer out, and look at the "
                                  "result by mesh_viewer --screenshot_path"));
  }
}

void RefineWorkspace(RefinerOptions options, Console* console) {
  const RefinementPaths paths = FindRefinementPaths(options);
  options.ChooseTrim(paths.HasFusedPoints());
  CheckOutputs(options, paths);
  if (options.viewer) {
    RefineInWindow(options, paths, console);
  } else {
    Refiner(options, paths, console, nullptr).Run();
  }
}

void Refine(const RefinerOptions& options, Console* console) {
  if (options.plan_path.empty()) {
    RefineWorkspace(options, console);
  } else if (options.tile >= 0) {
    RefineTile(options, ColmapPictureDecoder(), console);
  } else {
    PlanRefinement(options, ColmapPictureDecoder(), console);
  }
}

}  // namespace

int RunFacetwiseRefiner(int argc, char** argv) {
  return RunCommand(argc, argv, &AddRefinerOptions, &Refine,
                    {"a smaller --max_memory_gb keeps fewer images, and a "
                     "larger --FacetwiseRefinement.max_face_area makes fewer "
                     "faces",
                     "the mesh, fused.ply.vis, sparse/ and images/",
                     {{Alternative::kLeavePicturesOut,
                       ", or go on without them with "
                       "--FacetwiseRefinement.skip_missing_images 1"}}});
}

}  // namespace colmap_ext
