#include "colmap_ext/options/add_meshing_options.h"

#include <string>

namespace colmap_ext {

namespace {

void AddPathOptions(CommandOptions* manager, MesherOptions* mesher) {
  manager->AddDefaultOption(
      "workspace_path", &mesher->workspace_path,
      "The dense workspace, with sparse/, fused.ply and fused.ply.vis, or a "
      "folder with one such in dense/ or dense/0/. The mesh is written to "
      "WORKSPACE/meshed-delaunay-manifold.ply");
  manager->AddDefaultOption(
      "input_path", &mesher->input_path,
      "As delaunay_mesher has it, instead of workspace_path: the dense "
      "workspace or the sparse model");
  manager->AddDefaultOption(
      "fused_path", &mesher->words.fused_path,
      "The fused points, PLY, where they are not fused.ply of the workspace; "
      "their .vis lies beside them");
  manager->AddDefaultOption("output_path", &mesher->output_path,
                            "The mesh; required with input_path");
  manager->AddDefaultOption(
      "sparse_path", &mesher->sparse_path,
      "The cameras, a sparse model or a folder with one, such as "
      "WORKSPACE/sparse-refined. Default: WORKSPACE/sparse");
  manager->AddDefaultOption(
      "report_path", &mesher->report_path,
      "A page on the run, HTML: figures, and pictures from three cameras");
  manager->AddDefaultOption(
      "plan", &mesher->plan_path,
      "The folder of mesh_planner. One tile of it is done, with the plan's "
      "options; mesh_merger makes the mesh of all");
  manager->AddNumber("tile", &mesher->tile, kCountOrMinusOne,
                     "The tile of the plan");
  manager->AddDefaultOption("input_type", &mesher->words.input_type,
                            "{dense, sparse}");
  manager->AddDefaultOption(
      "image_order", &mesher->words.image_order,
      "How fused.ply.vis counts the images, where it can not be told: {auto, "
      "file, image_id, frame, frame_id}");
}

void AddVoteOptions(CommandOptions* manager, MesherOptions* mesher) {
  ManifoldMeshingOptions* meshing = &mesher->meshing;
  manager->AddNumber(
      "DelaunayManifoldMeshing.max_proj_dist", &meshing->max_proj_dist,
      kNotNegative,
      "[px] Points closer than this in an image are one; 0 keeps every point");
  manager->AddNumber("DelaunayManifoldMeshing.max_depth_dist",
                     &meshing->max_depth_dist, {0, 1},
                     "... unless their depths differ by more than this share");
  manager->AddDefaultOption(
      "DelaunayManifoldMeshing.alpha_kind", &mesher->words.alpha_kind,
      "Weight of an observation, {tracks, constant}: 1 - exp(-n^2 / (2 s^2)) "
      "for a point that n images see, s = visibility_sigma, or alpha_vis");
  manager->AddNumber("DelaunayManifoldMeshing.visibility_sigma",
                     &meshing->visibility_sigma, kPositive,
                     "[images] How many see a well-seen point; higher "
                     "counts points less that few images see");
  manager->AddNumber("DelaunayManifoldMeshing.alpha_vis", &meshing->alpha_vis,
                     {1e-6, 1},
                     "Weight of an observation where alpha_kind is "
                     "constant");
  manager->AddNumber(
      "DelaunayManifoldMeshing.distance_sigma_factor",
      &meshing->distance_sigma_factor, kPositive,
      "Times the 25th percentile of edge lengths is the distance sigma, the "
      "expected noise of the points");
  manager->AddNumber("DelaunayManifoldMeshing.behind_sigma",
                     &meshing->behind_sigma, kPositive,
                     "[distance sigmas] How far behind a point matter "
                     "is expected");
  manager->AddDefaultOption(
      "DelaunayManifoldMeshing.weak_surfaces", &meshing->weak_surfaces,
      "Strengthen matter where free space ends sharply behind a point: keeps "
      "surface that few points bear out");
  manager->AddNumber("DelaunayManifoldMeshing.quality_regularization",
                     &meshing->quality_regularization, {0, 1e4},
                     "Higher is smoother");
}

void AddSurfaceOptions(CommandOptions* manager, MesherOptions* mesher) {
  ManifoldMeshingOptions* meshing = &mesher->meshing;
  manager->AddDefaultOption(
      "DelaunayManifoldMeshing.preemptive_fixing", &meshing->preemptive_fixing,
      "Relabel and split cells around singular vertices before the surface is "
      "extracted");
  manager->AddDefaultOption(
      "DelaunayManifoldMeshing.fixing_rule", &mesher->words.fixing_rule,
      "How that chooses, {energy, paper}: what leaves the "
      "fewest pieces at the least energy, or in the "
      "paper's three passes");
  manager->AddNumber(
      "DelaunayManifoldMeshing.max_side_length_factor",
      &meshing->max_side_length_factor, kNotNegative,
      "Faces whose longest side exceeds the percentile by this factor are "
      "dropped; 0 keeps all");
  manager->AddNumber("DelaunayManifoldMeshing.max_side_length_percentile",
                     &meshing->max_side_length_percentile, {0, 100},
                     "[%] The percentile of all sides");
  manager->AddNumber("DelaunayManifoldMeshing.min_component_faces",
                     &meshing->min_component_faces, {0},
                     "[faces] Components of fewer are dropped");
  manager->AddNumber(
      "DelaunayManifoldMeshing.trim", &meshing->borders.trim, {0, 1},
      "Faces of less confidence are dropped: 0.2 leaves what the points bear "
      "out; 0: none");
  manager->AddNumber(
      "DelaunayManifoldMeshing.close_holes", &meshing->borders.close_holes,
      kCountOrMinusOne,
      "[edges] Holes of up to as many are closed; -1: all, 0: none");
  manager->AddDefaultOption("DelaunayManifoldMeshing.remeshing",
                            &meshing->remeshing,
                            "Remesh the surface at last: faces of good shape");
  manager->AddDefaultOption(
      "DelaunayManifoldMeshing.half_pixel_correction",
      &mesher->half_pixel_correction,
      "Move fused points by the half pixel that COLMAP's stereo is off");
  manager->AddDefaultOption(
      "DelaunayManifoldMeshing.half_pixel_calibration",
      &mesher->half_pixel_calibration,
      "... times what the sparse points show them to be off, 1 for half a "
      "pixel");
  manager->AddNumber("DelaunayManifoldMeshing.num_threads",
                     &mesher->num_threads, kThreads,
                     "[threads] -1 for all; the result does not depend on it");
}

// Where the meaning is COLMAP's.
void AddAliases(CommandOptions* manager, MesherOptions* mesher) {
  const std::string ours = "DelaunayManifoldMeshing.";
  const std::string colmaps = "DelaunayMeshing.";
  manager->AddAlias(colmaps + "max_proj_dist", ours + "max_proj_dist",
                    ", but counts pixels of the cameras where images are of "
                    "another size",
                    &mesher->has_camera_pixels);
  for (const char* name :
       {"max_depth_dist", "visibility_sigma", "distance_sigma_factor",
        "quality_regularization", "max_side_length_factor",
        "max_side_length_percentile", "num_threads"}) {
    manager->AddAlias(colmaps + name, ours + name);
  }
}

}  // namespace

void AddMeshingOptions(CommandOptions* manager, MesherOptions* mesher) {
  AddVoteOptions(manager, mesher);
  AddSurfaceOptions(manager, mesher);
}

void AddMesherOptions(CommandOptions* manager, MesherOptions* mesher) {
  AddPathOptions(manager, mesher);
  AddSceneOptions(manager, "What is meshed", &mesher->scene);
  manager->AddDefaultOption(
      "mask_background", &mesher->mask_background,
      "Masked pixels are background: what is seen through them is free space");
  AddMeshingOptions(manager, mesher);
  AddAliases(manager, mesher);
}

}  // namespace colmap_ext
