#include "colmap_ext/options/tiling_options.h"

#include "colmap_ext/errors.h"
#include "colmap_ext/options/add_meshing_options.h"
#include "formats/read_transform.h"

namespace colmap_ext {

void PlannerOptions::Finish() {
  if (output_path.empty()) {
    throw OptionError("--output_path is required: the plan's folder");
  }
  if (mesher.meshing.weak_surfaces) {
    throw OptionError(
        "DelaunayManifoldMeshing.weak_surfaces compares each ray with all "
        "others, which no tile knows: leave it out");
  }
  mesher.Finish();
}

void MergerOptions::Finish() {
  if (plan_path.empty() || output_path.empty()) {
    throw OptionError("--plan and --output_path are required");
  }
  if (!transform_path.empty()) {
    transform = ReadTransform(transform_path);
  }
}

void AddPlannerOptions(CommandOptions* manager, PlannerOptions* planner) {
  MesherOptions* mesher = &planner->mesher;
  manager->AddDefaultOption("workspace_path", &mesher->workspace_path,
                            "The dense workspace, as "
                            "delaunay_manifold_mesher takes it");
  manager->AddDefaultOption("output_path", &planner->output_path,
                            "The plan, a folder. What is there of the same "
                            "plan is kept");
  manager->AddNumber("max_memory_gb", &planner->max_memory_gb, kGigabytes,
                     "[GB] What the job of a tile may take");
  manager->AddNumber("num_tiles", &planner->num_tiles, {0},
                     "[tiles] 0: as many as max_memory_gb asks for");
  manager->AddNumber("distance_sigma", &planner->distance_sigma, kLength,
                     "[scene units] The expected noise of the points; 0: as "
                     "DelaunayManifoldMeshing.distance_sigma_factor says");
  manager->AddNumber(
      "seam_rings", &planner->seam_rings, kCountOrMinusOne,
      "[cells] How wide the merger cuts again on both sides of a seam; -1: "
      "wherever one machine could decide otherwise, which takes memory");
  manager->AddDefaultOption("fused_path", &mesher->words.fused_path,
                            "The fused points, where they are not fused.ply of "
                            "the workspace");
  manager->AddDefaultOption("sparse_path", &mesher->sparse_path,
                            "The cameras. Default: WORKSPACE/sparse");
  manager->AddDefaultOption(
      "mask_path", &mesher->scene.mask_path,
      "Masks of the images, a folder of PNG files, image.jpg.png for "
      "image.jpg: pixels of 0 are left out");
  manager->AddDefaultOption(
      "mask_background", &mesher->mask_background,
      "Masked pixels are background: what is seen through them is free space");
  manager->AddDefaultOption(
      "region", &mesher->scene.region.text,
      "What is meshed: a file (docs/scripts.md), two corners "
      "x0,y0,z0,x1,y1,z1 of a box, or auto: what most images look at, which "
      "mesh_merger writes to OUTPUT.region.txt");
  manager->AddDefaultOption("image_order", &mesher->words.image_order,
                            "How fused.ply.vis counts the images, where it can "
                            "not be told: {auto, file, image_id, frame, "
                            "frame_id}");
  AddMeshingOptions(manager, mesher);
}

void AddMergerOptions(CommandOptions* manager, MergerOptions* merger) {
  manager->AddDefaultOption("plan", &merger->plan_path,
                            "The folder of mesh_planner, all of whose tiles "
                            "are done");
  manager->AddDefaultOption("output_path", &merger->output_path, "The mesh");
  manager->AddDefaultOption("refined", &merger->is_refined,
                            "The mesh of the tiles as facetwise_refiner has "
                            "refined them");
  manager->AddDefaultOption(
      "transform_path", &merger->transform_path,
      "A transform of the mesh that is written, as model_aligner writes it; "
      "positions are double then");
  manager->AddNumber("num_threads", &merger->num_threads, kThreads,
                     "[threads] -1 for all; the result does not depend "
                     "on it");
}

}  // namespace colmap_ext
