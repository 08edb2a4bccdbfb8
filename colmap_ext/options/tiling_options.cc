#include "colmap_ext/options/tiling_options.h"

#include "colmap_ext/errors.h"
#include "formats/read_numbers.h"

namespace colmap_ext {

void PlannerOptions::Finish() {
  if (output_path.empty()) {
    throw OptionError("--output_path is required: the plan's folder");
  }
  if (mesher.meshing.weak_surfaces) {
    throw OptionError(
        "DelaunayManifoldMeshing.weak_surfaces compares each ray with all "
        "others, which no tile knows: omit it");
  }
  mesher.Finish();
}

void MergerOptions::Finish() {
  if (plan_path.empty() || output_path.empty()) {
    throw OptionError("--plan_path and --output_path are required");
  }
  if (!transform_path.empty()) {
    transform = ReadTransform(transform_path);
  }
}

void AddPlannerOptions(CommandOptions* options, PlannerOptions* planner) {
  options->SetSummary(
      "Splits a scene into tiles that delaunay_manifold_mesher meshes as "
      "independent\njobs, and prints the commands for Slurm or xargs.\n\n"
      "  colmap mesh_planner --workspace_path DIR --output_path PLAN\n");
  options->Add("workspace_path", &planner->mesher.workspace_path,
               "Dense workspace, as for delaunay_manifold_mesher; required");
  options->Add("output_path", &planner->output_path,
               "Plan folder; required. Files of the same plan are kept");
  options->AddNumber("max_memory_gb", &planner->max_memory_gb, kGigabytes,
                     "[GB] Memory of the job of one tile; higher makes fewer "
                     "tiles");
  AddMeshingInputOptions(options, &planner->mesher);
  options->SetGroup(OptionGroup::kAdvanced);
  options->AddNumber("num_tiles", &planner->num_tiles, {0},
                     "[tiles] Number of tiles; 0: by max_memory_gb");
  options->AddNumber("distance_sigma", &planner->distance_sigma, kLength,
                     "[scene units] Expected noise of the points; 0: by "
                     "DelaunayManifoldMeshing.distance_sigma_factor");
  options->AddNumber("seam_rings", &planner->seam_rings, kCountOrMinusOne,
                     "[cells] Width that the merger re-solves on both sides of "
                     "tile borders; -1: re-solve everything undecided: "
                     "identical to a single-machine run, more memory");
  options->SetGroup(OptionGroup::kBasic);
  AddMeshingOptions(options, &planner->mesher);
}

void AddMergerOptions(CommandOptions* options, MergerOptions* merger) {
  options->SetSummary(
      "Joins the tiles of a plan into one seamless 2-manifold mesh.\n\n"
      "  colmap mesh_merger --plan_path PLAN --output_path MESH.ply\n");
  options->Add("plan_path", &merger->plan_path,
               "Plan folder of mesh_planner, all of whose tiles are done; "
               "required");
  options->AddAlias("plan", "plan_path");
  options->Add("output_path", &merger->output_path,
               "Mesh to write, PLY, with its .vis; required");
  options->Add("refined", &merger->is_refined,
               "Merge the tiles as facetwise_refiner has refined them");
  AddTransformOption(&merger->transform_path, options);
  AddThreadsOption("", &merger->num_threads, options);
}

}  // namespace colmap_ext
