#include "colmap_ext/options/evaluation_options.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "formats/read_arrays.h"

namespace colmap_ext {

void EvaluatorOptions::Finish() {
  RefuseIf(mesh_path.empty() || truth_path.empty(),
           "--mesh_path and --truth_path are required");
  region.Finish();
  RefuseIf(region.is_auto && workspace_path.empty(),
           "--region auto needs --workspace_path");
  RefuseIf(observability_mask.empty() != observability_box.empty(),
           "--observability_mask and --observability_box go together");
  RefuseIf(
      !image_name.empty() && (workspace_path.empty() || picture_path.empty()),
      "--image_name needs --picture_path and --workspace_path");
  RefuseIf(!sparse_path.empty() && workspace_path.empty(),
           "--sparse_path needs --workspace_path");
  evaluation.depth_thresholds =
      ParseNumberList("depth_thresholds", depth_thresholds, 0);
  RefuseIf(!(std::ranges::min(evaluation.depth_thresholds) > 0),
           "depth_thresholds must be positive lengths");
}

Observability EvaluatorOptions::ReadObservability() const {
  Observability observability;
  if (!observability_mask.empty()) {
    const std::vector<double> box =
        ParseNumberList("observability_box", observability_box, 4);
    RefuseIf(!(box[3] > 0),
             "observability_box: the resolution must be positive");
    VoxelGrid grid = ReadNpyMask(observability_mask);
    observability.mask = ObservabilityMask{
        grid.size, std::move(grid.voxels), {box[0], box[1], box[2]}, box[3]};
  }
  if (!ground_plane.empty()) {
    observability.ground_plane = Eigen::Vector4d(
        ParseNumberList("ground_plane", ground_plane, 4).data());
  }
  return observability;
}

void AddEvaluatorOptions(CommandOptions* options, EvaluatorOptions* evaluator) {
  options->SetSummary(
      "Measures the accuracy, completeness and topology of a mesh against "
      "ground truth.",
      {"mesh_evaluator --mesh_path MESH.ply --truth_path TRUTH.ply"});
  MeshEvaluationOptions* const evaluation = &evaluator->evaluation;
  const std::string ours = "MeshEvaluation.";
  options->Add("mesh_path", &evaluator->mesh_path, "Mesh, PLY; required");
  options->Add(
      "truth_path", &evaluator->truth_path,
      "Ground truth in the same frame: a mesh or points, PLY, or a folder of "
      "COLMAP depth maps IMAGE_NAME[.geometric].bin; required");
  options->Add("workspace_path", &evaluator->workspace_path,
               "Workspace or sparse model with undistorted images. Count only "
               "surface that the images see, and compare depths");
  AddSparsePathOption(&evaluator->sparse_path, options);
  options->Add("json_path", &evaluator->json_path, "Write the figures as JSON");
  options->Add("error_mesh_path", &evaluator->error_mesh_path,
               "Write the mesh colored by the distances of its vertices to the "
               "truth, PLY");
  options->Add("picture_path", &evaluator->picture_path,
               "Write a picture of the colored mesh with its scale, PNG");
  options->Add("image_name", &evaluator->image_name,
               "Draw the picture from the camera of this image");
  AddRegionOption("Count only samples inside", &evaluator->region,
                  "; auto: the part that most images look at", options);
  options->Add(ours + "stride", &evaluation->stride, {1, 1000},
               "[px] Cast a ray through every n-th pixel of a row and column");
  options->Add(ours + "spacing", &evaluation->spacing, kLength,
               "[scene units] Take one sample per cube of this side; 0: 0.001 "
               "times the truth's diagonal. DTU: 0.2 mm");
  options->Add(ours + "max_distance", &evaluation->max_distance, kLength,
               "[scene units] Clip distances at this; 0: 0.05 times the "
               "truth's diagonal. DTU: 20 mm");
  options->Add(ours + "drop_beyond", &evaluation->drop_beyond,
               "Ignore distances beyond max_distance instead of clipping them, "
               "as DTU's own evaluation does");
  options->Add(ours + "depth_thresholds", &evaluator->depth_thresholds,
               "[scene units] Errors below which a depth counts as correct. "
               "EPFL: 0.02,0.1 m");
  options->AddThreads("MeshEvaluation");
  options->SetGroup(OptionGroup::kAdvanced);
  options->Add("observability_mask", &evaluator->observability_mask,
               "Count samples of the mesh only where this NumPy array [X,Y,Z] "
               "of uint8 is not 0 (DTU's ObsMask)");
  options->Add(
      "observability_box", &evaluator->observability_box,
      "minx,miny,minz,resolution of that array (DTU's BB(1,:) and Res)");
  options->Add("ground_plane", &evaluator->ground_plane,
               "a,b,c,d: count samples of the truth only where ax + by + cz + "
               "d > 0 (DTU's Plane)");
  options->Add(ours + "error_scale", &evaluator->error_scale, kLength,
               "[scene units] Error shown by the last color; 0: above 95 % of "
               "the errors");
}

}  // namespace colmap_ext
