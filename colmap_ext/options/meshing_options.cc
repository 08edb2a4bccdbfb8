#include "colmap_ext/options/meshing_options.h"

#include "formats/read_numbers.h"

namespace colmap_ext {
namespace {

constexpr const char* kMeshingSection = "DelaunayManifoldMeshing.";

void AddPathOptions(CommandOptions* options, MesherOptions* mesher) {
  options->Add("workspace_path", &mesher->workspace_path,
               "Dense workspace with sparse/, fused.ply and fused.ply.vis, or "
               "a folder that has it in dense/ or dense/0/. Required, except "
               "with input_path or plan_path");
  options->Add("output_path", &mesher->output_path,
               "Mesh to write, PLY, with its .vis. Default: "
               "WORKSPACE/meshed-delaunay-manifold.ply");
  options->Add("report_path", &mesher->report_path,
               "Write a report, an HTML page with figures and pictures");
  options->SetGroup(OptionGroup::kAdvanced);
  options->Add(
      "input_path", &mesher->input_path,
      "Same as delaunay_mesher's --input_path: the dense workspace or the "
      "sparse model, instead of workspace_path. Requires output_path");
  options->AddWord(
      "input_type", &mesher->workspace.input_type,
      {{"dense", InputType::kDense}, {"sparse", InputType::kSparse}},
      "Mesh the fused points, or the points of the sparse model");
  options->Add(std::string(kMeshingSection) + "carve_with_depth_maps",
               &mesher->carve_with_depth_maps,
               "Carve free space along all depths of stereo/depth_maps, fused "
               "or not: less false surface, and less that few images see");
  options->Add("plan_path", &mesher->plan_path,
               "Plan folder of mesh_planner. With tile: mesh this tile of it, "
               "with the options of the plan");
  options->Add("tile", &mesher->tile, kCountOrMinusOne,
               "Index of the tile to mesh; -1: none");
  options->SetGroup(OptionGroup::kBasic);
}

void AddPointOptions(CommandOptions* options, MesherOptions* mesher) {
  const std::string ours = kMeshingSection;
  ManifoldMeshingOptions* const meshing = &mesher->meshing;
  options->AddPreset(
      "quality",
      {{"low", [=] { meshing->thinning.max_proj_dist = 40; }},
       {"medium", [=] { meshing->thinning.max_proj_dist = 28; }},
       {"high", [] {}},
       {"extreme", [=] { meshing->thinning.max_proj_dist = 10; }}},
      2,
      // scripts/option_tables looks for "Preset of".
      "Preset of max_proj_dist: 40, 28, 20 or 10 px. A "
      "max_proj_dist that is given has priority");
  options->Add(
      ours + "max_proj_dist", &meshing->thinning.max_proj_dist, kNotNegative,
      "[px] Leave out points nearer than a fifth of this to one that is "
      "kept; higher is coarser and faster. 0: keep every point");
  options->Add(ours + "quality_regularization",
               &meshing->quality_regularization, {0, 1e4},
               "Weight of the surface quality; higher is smoother");
  options->Add(
      ours + "smoothing", &meshing->smoothing, {0, 10},
      "Strength of the final smoothing, which moves vertices by about the "
      "noise of the points around them. 0: keep the vertices at fused points");
  options->Add(ours + "min_confidence", &meshing->borders.trim, {0, 1},
               "Remove faces with a lower confidence; 0.2 removes membranes "
               "that span sky or openings. 0: keep all");
  options->Add(ours + "close_holes", &meshing->borders.close_holes,
               {0, kNoLimit, kAllLoops},
               "[px] Close holes up to this wide in the median of their "
               "views; 0: none, -1: all, even the outer border");
  options->Add(ours + "min_component_faces", &meshing->min_component_faces, {0},
               "[faces] Remove components with fewer faces");
  options->Add(ours + "max_side_length_factor",
               &meshing->max_side_length_factor, kNotNegative,
               "Remove faces whose longest side is longer than this times the "
               "max_side_length_percentile of all faces' longest sides, "
               "unless they continue flat surface; 0: keep all");
  options->Add(ours + "remeshing", &meshing->remeshing,
               "Remesh the final surface into well-shaped faces, for meshes "
               "that are not refined");
  options->SetGroup(OptionGroup::kAdvanced);
  options->Add(ours + "max_side_length_percentile",
               &meshing->max_side_length_percentile, {0, 100},
               "[%] Percentile that max_side_length_factor multiplies");
  options->Add(
      ours + "max_depth_dist", &meshing->thinning.max_depth_dist, {0, 1},
      "Leave out points only if nearer to one that is kept than this fraction "
      "of their depth");
  options->Add(
      ours + "drop_weaker_layers", &meshing->drop_weaker_layers,
      "Where groups of images disagree and a wall is there twice, drop the "
      "points of the weaker layer; 0: keep both");
  options->Add(ours + "visibility_sigma", &meshing->visibility_sigma, kPositive,
               "[images] Images at which a point counts as well supported; "
               "higher values down-weight points seen by few images");
  options->Add(ours + "distance_sigma_factor", &meshing->distance_sigma_factor,
               kPositive,
               "Expected noise of the points, as a multiple of the 25th "
               "percentile of edge lengths; higher is smoother");
  options->AddWord(
      ours + "half_pixel_correction", &mesher->half_pixel,
      {{"auto", HalfPixelCorrection::kAuto},
       {"full", HalfPixelCorrection::kFull},
       {"off", HalfPixelCorrection::kOff}},
      "Correct the half-pixel offset of COLMAP's fused points, by the amount "
      "that the sparse points show, by half a pixel, or not");
}

void AddAblationOptions(CommandOptions* options, MesherOptions* mesher) {
  const std::string ours = kMeshingSection;
  ManifoldMeshingOptions* const meshing = &mesher->meshing;
  options->SetGroup(OptionGroup::kAblations);
  options->Add(ours + "alpha_vis", &mesher->alpha_vis, {1e-6, 1, 0},
               "Weight of every observation; 0: 1 - exp(-n^2 / (2 s^2)) for a "
               "point seen by n images, s = visibility_sigma");
  options->Add(ours + "behind_sigma", &meshing->behind_sigma, kPositive,
               "[distance sigmas] Assumed depth of solid behind a point");
  options->Add(ours + "preemptive_fixing", &meshing->preemptive_fixing,
               "Relabel and split cells around singular vertices before the "
               "surface is extracted; 0: split these vertices instead");
  options->AddWord(
      ours + "fixing_rule", &meshing->fixing_rule,
      {{"energy", FixingRule::kEnergy}, {"paper", FixingRule::kPaper}},
      "How singular vertices are removed: fewest remaining at the lowest cut "
      "energy, or the paper's three passes");
  options->SetGroup(OptionGroup::kBasic);
}

void AddColmapAliases(CommandOptions* options, MesherOptions* mesher) {
  const std::string colmaps = "DelaunayMeshing.";
  options->AddAlias(
      colmaps + "max_proj_dist", std::string(kMeshingSection) + "max_proj_dist",
      ", but in pixels of the cameras if images have another size",
      &mesher->has_camera_pixels);
  for (const char* name :
       {"max_depth_dist", "visibility_sigma", "distance_sigma_factor",
        "quality_regularization", "max_side_length_factor",
        "max_side_length_percentile"}) {
    options->AddAlias(colmaps + name, kMeshingSection + std::string(name));
  }
  options->AddAlias(colmaps + "num_threads", "num_threads");
}

// Those of the input that mesh_planner has too.
void AddMeshingInputOptions(CommandOptions* options, MesherOptions* mesher) {
  AddRegionOption("Mesh only inside", &mesher->scene.region, kWrittenAutoRegion,
                  options);
  AddMaskOption(&mesher->scene.mask_path, options);
  options->Add("mask_background", &mesher->mask_background,
               "Treat masked pixels as background: everything along their rays "
               "is empty");
  options->AddThreads("DelaunayManifoldMeshing");
  options->SetGroup(OptionGroup::kAdvanced);
  AddFusedPathOption(&mesher->workspace.fused_path, options);
  AddSparsePathOption(&mesher->workspace.sparse_path, options);
  AddImageOrderOption(&mesher->workspace.image_order, options);
  options->SetGroup(OptionGroup::kBasic);
}

}  // namespace

std::filesystem::path MesherOptions::InputPath() const {
  return workspace_path.empty() ? input_path : workspace_path;
}

void MesherOptions::Finish() {
  if (!plan_path.empty() || tile >= 0) {
    RefuseIf(plan_path.empty() || tile < 0,
             "--plan_path and --tile belong together");
    RefuseIf(
        !InputPath().empty() || !output_path.empty() || !report_path.empty(),
        "--plan_path determines what is meshed: omit --workspace_path, "
        "--input_path, --output_path and --report_path");
    return;
  }
  RefuseIf(workspace_path.empty() == input_path.empty(),
           "either --workspace_path or --input_path is required");
  RefuseIf(!input_path.empty() && output_path.empty(),
           "--output_path is required with --input_path");
  RefuseIf(!report_path.empty() &&
               std::filesystem::path(report_path).extension() != ".html",
           "--report_path is a page, and ends in .html");
  RefuseIf(workspace.input_type == InputType::kSparse &&
               !workspace.fused_path.empty(),
           "--fused_path is for dense input, not for sparse");
  scene.Finish();
  RefuseIf(mask_background && scene.mask_path.empty(),
           "--mask_background needs --mask_path");
  if (alpha_vis > 0) {
    meshing.alpha_kind = ObservationWeight::kConstant;
    meshing.alpha_vis = alpha_vis;
  }
}

void AddMesherOptions(CommandOptions* options, MesherOptions* mesher) {
  options->SetSummary(
      "Makes a 2-manifold triangle mesh of the fused points of a dense "
      "workspace, by\na Delaunay triangulation and a minimum cut.",
      {"delaunay_manifold_mesher --workspace_path DIR"});
  AddPathOptions(options, mesher);
  AddMeshingInputOptions(options, mesher);
  AddTransformOption(&mesher->scene.transform_path, options);
  AddPointOptions(options, mesher);
  AddAblationOptions(options, mesher);
  AddColmapAliases(options, mesher);
}

void PlannerOptions::Finish() {
  RefuseIf(output_path.empty(), "--output_path is required: the plan's folder");
  mesher.Finish();
}

void MergerOptions::Finish() {
  RefuseIf(plan_path.empty() || output_path.empty(),
           "--plan_path and --output_path are required");
  if (!transform_path.empty()) {
    transform = ReadTransform(transform_path);
  }
}

void AddPlannerOptions(CommandOptions* options, PlannerOptions* planner) {
  options->SetSummary(
      "Splits a scene into tiles that delaunay_manifold_mesher meshes as "
      "independent\njobs, and prints the commands for Slurm or xargs.",
      {"mesh_planner --workspace_path DIR --output_path PLAN"});
  options->Add("workspace_path", &planner->mesher.workspace_path,
               "Dense workspace, as for delaunay_manifold_mesher; required");
  options->Add("output_path", &planner->output_path,
               "Plan folder; required. Files of the same plan are kept");
  options->Add("max_memory_gb", &planner->max_memory_gb, kGigabytes,
               "[GB] Memory of the job of one tile; higher makes fewer tiles");
  AddMeshingInputOptions(options, &planner->mesher);
  options->SetGroup(OptionGroup::kAdvanced);
  options->Add("num_tiles", &planner->num_tiles, {0},
               "[tiles] Number of tiles; 0: by max_memory_gb");
  options->Add("distance_sigma", &planner->distance_sigma, kLength,
               "[scene units] Expected noise of the points; 0: by "
               "DelaunayManifoldMeshing.distance_sigma_factor");
  options->Add("seam_rings", &planner->seam_rings, kCountOrMinusOne,
               "[cells] Width that the merger re-solves on both sides of tile "
               "borders; -1: re-solve everything undecided: identical to a "
               "single-machine run, more memory");
  options->SetGroup(OptionGroup::kBasic);
  AddPointOptions(options, &planner->mesher);
  AddAblationOptions(options, &planner->mesher);
}

void AddMergerOptions(CommandOptions* options, MergerOptions* merger) {
  options->SetSummary(
      "Joins the tiles of a plan into one seamless 2-manifold mesh.",
      {"mesh_merger --plan_path PLAN --output_path MESH.ply"});
  options->Add(
      "plan_path", &merger->plan_path,
      "Plan folder of mesh_planner, all of whose tiles are done; required");
  options->Add("output_path", &merger->output_path,
               "Mesh to write, PLY, with its .vis; required");
  options->Add("refined", &merger->is_refined,
               "Merge the tiles that facetwise_refiner has refined");
  AddTransformOption(&merger->transform_path, options);
  options->AddThreads();
}

}  // namespace colmap_ext
