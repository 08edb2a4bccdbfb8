#include <filesystem>
#include <utility>
#include <vector>

#include "colmap_ext/colmap_compat.h"
#include "colmap_ext/commands.h"
#include "colmap_ext/options/evaluation_options.h"
#include "colmap_ext/report/print_report.h"
#include "colmap_ext/run_command.h"
#include "colmap_ext/viewing/scene_loader.h"
#include "evaluation/mesh_evaluation.h"
#include "formats/atomic_file.h"
#include "formats/errors.h"
#include "formats/picture_files.h"
#include "formats/read_ply.h"
#include "formats/write_mesh.h"
#include "pictures/pictures.h"
#include "workspace/workspace.h"
#include "workspace/workspace_paths.h"

namespace colmap_ext {
namespace {

namespace fs = std::filesystem;

// Before the work.
void CheckOutputs(const EvaluatorOptions& options) {
  std::vector<fs::path> inputs = {options.mesh_path, options.observability_mask,
                                  options.region.text};
  if (!fs::is_directory(options.truth_path)) {
    inputs.emplace_back(options.truth_path);
  }
  ExpectOutputs(
      {options.json_path, options.error_mesh_path, options.picture_path},
      WorkspaceInputs(options.workspace_path, {}, options.sparse_path,
                      std::move(inputs)));
}

// Of the workspace; empty without one.
struct EvaluatedViews {
  std::vector<View> views;
  std::vector<Eigen::Vector3f> sparse_points;
};

EvaluatedViews ReadEvaluatedViews(const EvaluatorOptions& options) {
  if (options.workspace_path.empty()) {
    return {};
  }
  const fs::path sparse_path =
      FindSparseFolder(options.sparse_path.empty() ? options.workspace_path
                                                   : options.sparse_path);
  SparseModel model = ReadSparseModel(sparse_path);
  std::vector<View> views =
      ReadViews(options.workspace_path, model, {}, ColmapPictureDecoder())
          .views;
  if (views.empty()) {
    throw FileError(sparse_path, "it has no images");
  }
  return {std::move(views), std::move(model.point_positions)};
}

// \pre views outlive what is returned
Truth ReadTruth(const EvaluatorOptions& options,
                const std::vector<View>& views) {
  if (!fs::is_directory(options.truth_path)) {
    return {ReadPlyMesh(options.truth_path), nullptr};
  }
  RefuseIf(!options.error_mesh_path.empty() || !options.picture_path.empty(),
           "--error_mesh_path and --picture_path need a mesh or points as the "
           "truth, not depth maps");
  RefuseIf(
      views.empty(),
      "a --truth_path of depth maps needs --workspace_path, which has their "
      "cameras");
  Truth truth;
  truth.depth_maps = DepthMapReader(options.truth_path, views);
  return truth;
}

TriangleMesh ReadMesh(const EvaluatorOptions& options) {
  TriangleMesh mesh = ReadPlyMesh(options.mesh_path);
  if (mesh.facets.empty()) {
    throw FileError(options.mesh_path, "it has no faces: not a mesh");
  }
  return mesh;
}

View PictureView(const EvaluatorOptions& options, const TriangleMesh& mesh,
                 const std::vector<View>& views) {
  constexpr int kWidth = 1024;  // px
  constexpr int kHeight = 768;  // px
  if (options.image_name.empty()) {
    return AutomaticView(mesh, kWidth, kHeight);
  }
  return CropView(views[FindView(views, options.image_name)], 1, 0.5, 0.5,
                  kWidth, kHeight);
}

void WriteErrors(const EvaluatorOptions& options, const TriangleMesh& mesh,
                 const Truth& truth, const View& view, double max_distance,
                 AtomicFiles* files) {
  const std::vector<double> errors = VertexErrors(mesh, truth, max_distance);
  const double scale =
      options.error_scale > 0 ? options.error_scale : ErrorScale(errors);
  std::vector<Color> colors;
  colors.reserve(errors.size());
  for (const double error : errors) {
    colors.push_back(ErrorColor(error, scale));
  }
  if (!options.error_mesh_path.empty()) {
    WriteColoredMesh(options.error_mesh_path, mesh, colors, files);
  }
  if (!options.picture_path.empty()) {
    WriteText(options.picture_path,
              EncodePng(DrawErrors(mesh, colors, view, scale)), files);
  }
}

void Evaluate(const EvaluatorOptions& options, Console* console) {
  CheckOutputs(options);
  const Progress& progress = console->progress;
  Report(progress, "Reading", 0);
  const auto [views, sparse_points] = ReadEvaluatedViews(options);
  const TriangleMesh mesh = ReadMesh(options);
  const Truth truth = ReadTruth(options, views);
  const View picture_view = PictureView(options, mesh, views);
  Observability observability = options.ReadObservability();
  observability.region = options.region.Resolve(views, sparse_points);
  const MeshEvaluation evaluation = EvaluateMesh(
      options.evaluation, mesh, truth, views, observability, progress);
  AtomicFiles files;
  if (!options.error_mesh_path.empty() || !options.picture_path.empty()) {
    Report(progress, "Colouring the errors", 0);
    WriteErrors(options, mesh, truth, picture_view,
                evaluation.distances->max_distance, &files);
  }
  if (!options.json_path.empty()) {
    WriteText(options.json_path, EvaluationJson(options, evaluation), &files);
  }
  files.Commit();
  console->reporter.Finish();
  PrintReport(observability.region, &console->log);
  PrintEvaluation(options, evaluation, &console->log);
  console->PrintTime();
}

}  // namespace

int RunMeshEvaluator(int argc, char** argv) {
  return RunCommand(
      argc, argv, &AddEvaluatorOptions, &Evaluate,
      {"a larger --MeshEvaluation.stride or --MeshEvaluation.spacing takes "
       "fewer samples",
       "the mesh and the truth"});
}

}  // namespace colmap_ext
