#include "colmap_ext/options/add_evaluation_options.h"

namespace colmap_ext {

namespace {

void AddPathOptions(CommandOptions* manager, EvaluatorOptions* evaluator) {
  manager->AddDefaultOption("mesh_path", &evaluator->mesh_path,
                            "The mesh, PLY; required");
  manager->AddDefaultOption(
      "truth_path", &evaluator->truth_path,
      "What is true, in the same frame: a mesh or points, PLY, or a folder of "
      "COLMAP's depth maps IMAGE_NAME[.geometric].bin; required");
  manager->AddDefaultOption(
      "workspace_path", &evaluator->workspace_path,
      "Count only what the images of this workspace or sparse model see, and "
      "compare depths; undistorted images only");
  manager->AddDefaultOption(
      "sparse_path", &evaluator->sparse_path,
      "The cameras, a sparse model or a folder with one, such as "
      "WORKSPACE/sparse-refined. Default: that of the workspace");
  manager->AddDefaultOption("json_path", &evaluator->json_path,
                            "The figures as JSON");
  manager->AddDefaultOption(
      "error_mesh_path", &evaluator->error_mesh_path,
      "The mesh coloured by its vertices' distances to the truth, PLY");
  manager->AddDefaultOption("picture_path", &evaluator->picture_path,
                            "A picture of that with its scale, PNG");
  manager->AddDefaultOption("picture_image", &evaluator->picture_image,
                            "... seen by the workspace's image of this name");
}

void AddObservabilityOptions(CommandOptions* manager,
                             EvaluatorOptions* evaluator) {
  manager->AddDefaultOption(
      "region", &evaluator->region.text,
      "Count samples inside: a file (docs/scripts.md), two corners "
      "x0,y0,z0,x1,y1,z1 of a box, or auto: what most images of the workspace "
      "look at");
  manager->AddDefaultOption(
      "observability_mask", &evaluator->observability_mask,
      "Count samples of the mesh only where this NumPy array [X,Y,Z] of uint8 "
      "is not 0 (DTU's ObsMask)");
  manager->AddDefaultOption("observability_box", &evaluator->observability_box,
                            "minx,miny,minz,resolution of that array (DTU's "
                            "BB(1,:) and Res)");
  manager->AddDefaultOption(
      "ground_plane", &evaluator->ground_plane,
      "a,b,c,d: count samples of the truth only where ax+by+cz+d > 0 (DTU's "
      "Plane)");
}

}  // namespace

void AddEvaluatorOptions(CommandOptions* manager, EvaluatorOptions* evaluator) {
  AddPathOptions(manager, evaluator);
  AddObservabilityOptions(manager, evaluator);
  MeshEvaluationOptions* evaluation = &evaluator->evaluation;
  manager->AddNumber("MeshEvaluation.stride", &evaluation->stride, {1, 1000},
                     "[px] Rays are cast through every so many pixels");
  manager->AddNumber("MeshEvaluation.spacing", &evaluation->spacing, kLength,
                     "[scene units] Samples are one for each cube of "
                     "this side; 0: 0.001 times "
                     "the truth's diagonal; DTU: 0.2 mm");
  manager->AddNumber(
      "MeshEvaluation.max_distance", &evaluation->max_distance, kLength,
      "[scene units] Distances are clipped at this; 0: 0.05 times the truth's "
      "diagonal; DTU: 20 mm");
  manager->AddDefaultOption(
      "MeshEvaluation.drop_beyond", &evaluation->drop_beyond,
      "Leave distances beyond out, as DTU's own evaluation does");
  manager->AddDefaultOption(
      "MeshEvaluation.depth_thresholds", &evaluator->depth_thresholds,
      "[scene units] Depths are right below these errors; EPFL: 0.02,0.1 m");
  manager->AddNumber("MeshEvaluation.error_scale", &evaluator->error_scale,
                     kLength,
                     "[scene units] Error at the end of the colours; 0: "
                     "above 95 % of the errors");
  manager->AddNumber("MeshEvaluation.num_threads", &evaluator->num_threads,
                     kThreads,
                     "[threads] -1 for all; the result does not depend on it");
}

}  // namespace colmap_ext
