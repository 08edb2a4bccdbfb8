#include "colmap_ext/options/refinement_options.h"

namespace colmap_ext {
namespace {

namespace fs = std::filesystem;

// An empty path stays empty.
fs::path WithExtension(const fs::path& path, const char* extension) {
  return path.empty() ? path : fs::path(path).replace_extension(extension);
}

void CheckPaths(const RefinerOptions& options) {
  RefuseIf(options.workspace_path.empty(), "--workspace_path is required");
  RefuseIf(!options.input_path.empty() && options.output_path.empty(),
           "--output_path is required with --input_path");
}

// A plan determines what is refined.
void CheckPlan(const RefinerOptions& options) {
  RefuseIf(options.plan_path.empty(), "--tile needs --plan_path");
  for (const std::string* path :
       {&options.workspace_path, &options.output_path, &options.fused_path,
        &options.sparse_path, &options.report_path, &options.labels_path,
        &options.scene.mask_path, &options.scene.transform_path,
        &options.scene.region.text}) {
    RefuseIf(!path->empty(),
             "--plan_path determines what is refined: omit masks, regions, "
             "transforms and all paths but --input_path");
  }
  RefuseIf(options.resume || options.viewer,
           "--resume and --viewer are not for plans: a job refines a whole "
           "tile");
  if (options.input_path.empty() != (options.tile >= 0)) {
    throw OptionError(
        options.tile >= 0
            ? "--input_path is for planning, without --tile"
            : "--plan_path needs --tile, or --input_path, the plan's mesh, to "
              "plan its refinement");
  }
}

void AddPathOptions(CommandOptions* options, RefinerOptions* refiner) {
  options->Add("workspace_path", &refiner->workspace_path,
               "Dense workspace with images/ and sparse/, or a folder that has "
               "it in dense/ or dense/0/; required, except with plan_path");
  options->Add("input_path", &refiner->input_path,
               "Mesh to refine, a PLY of triangles, with its .vis if there is "
               "one. Default: WORKSPACE/meshed-delaunay-manifold.ply");
  options->Add("output_path", &refiner->output_path,
               "Refined mesh to write; required with input_path. Default: "
               "WORKSPACE/meshed-refined.ply");
  options->Add("report_path", &refiner->report_path,
               "Write a report: NAME.html (page) and NAME.csv (iterations). "
               "Give either name");
  options->Add("resume", &refiner->resume,
               "Continue an interrupted run from its last complete level");
  options->Add("viewer", &refiner->viewer,
               "Show the mesh in a window while it changes. T pauses; closing "
               "the window does not end the refinement");
  options->SetGroup(OptionGroup::kAdvanced);
  AddFusedPathOption(&refiner->fused_path, options);
  AddSparsePathOption(&refiner->sparse_path, options);
  options->Add("labels_path", &refiner->labels_path,
               "Write the mesh with faces colored by the image pair that "
               "refined them, PLY");
  options->Add("plan_path", &refiner->plan_path,
               "Plan folder. With input_path, the mesh of mesh_merger: plan "
               "the refinement. With tile: refine this tile");
  options->Add("tile", &refiner->tile, kCountOrMinusOne,
               "Index of the tile to refine; -1: none");
  AddImageOrderOption(&refiner->image_order, options);
  options->SetGroup(OptionGroup::kBasic);
}

constexpr const char* kRefinementSection = "FacetwiseRefinement.";

void AddBasicOptions(CommandOptions* options, RefinerOptions* refiner) {
  const std::string ours = kRefinementSection;
  FacetwiseRefinementOptions* const refinement = &refiner->refinement;
  options->AddPreset(
      "quality",
      {{"low",
        [=] {
          refiner->image_scale = 0.5;
          refinement->levels = 2;
          refinement->iterations = 5;
          refinement->labeling.final_pairs_per_facet = 6;
        }},
       {"medium", [=] { refiner->image_scale = 0.7; }},
       {"high", [] {}},
       {"extreme",
        [=] {
          refinement->max_face_area = 4;
          refinement->labeling.final_pairs_per_facet = 54;
        }}},
      2,
      "Preset of image_scale, levels, iterations, max_face_area and "
      "final_pairs_per_face; options that are given have priority. low takes a "
      "quarter to a third of the time of high");
  options->Add(ours + "image_scale", &refiner->image_scale, {0.05, 1},
               "Scale of the images that are compared: 0.5 is half the width "
               "and height, and a quarter of the time");
  options->Add(
      ours + "levels", &refinement->levels, {1, 8},
      "[levels] Image sizes, coarse to fine; 3: a quarter, half and full size");
  options->Add(ours + "smoothness_weight", &refinement->smoothness_weight,
               kNotNegative,
               "Factor on the estimated smoothness; higher is smoother");
  options->Add(ours + "max_face_area", &refinement->max_face_area, {0.5, 1e6},
               "[px^2] Area of a face in the image where the surface is "
               "curved; higher makes fewer faces. Flat parts get larger faces");
  options->AddWord(ours + "refine_cameras", &refiner->refine_cameras,
                   {{"auto", std::nullopt},
                    {"none", RefinedParts::kNothing},
                    {"poses", RefinedParts::kPoses},
                    {"poses_intrinsics", RefinedParts::kPosesIntrinsics}},
                   "Camera parameters to refine before the surface, written to "
                   "WORKSPACE/sparse-refined, of a plan to "
                   "PLAN/sparse-refined. auto: poses, only if the images are "
                   "misaligned. The cameras of a rig move together");
  options->Add(ours + "min_confidence", &refiner->min_confidence,
               {0, 1, kAutoTrim, "auto"},
               "Remove faces with a lower confidence; 0: keep all. auto: 0.15, "
               "or 0 without fused points or if no face has as much");
  options->Add(ours + "close_holes", &refinement->borders.close_holes,
               {0, kNoLimit, kAllLoops},
               "[px] Close holes up to this wide in the median of their "
               "views; 0: none, -1: all, even the outer border");
  options->Add(ours + "skip_missing_images", &refiner->skip_missing_images,
               "Continue without images that are missing, unreadable, or not "
               "of their camera's size");
}

void AddAdvancedOptions(CommandOptions* options, RefinerOptions* refiner) {
  const std::string ours = kRefinementSection;
  FacetwiseRefinementOptions* const refinement = &refiner->refinement;
  options->SetGroup(OptionGroup::kAdvanced);
  options->Add(
      ours + "iterations", &refinement->iterations, {1},
      "[iterations] Maximum number at each level, without the last four");
  options->Add(
      ours + "min_zncc", &refinement->min_zncc, {-1, 1},
      "Refine faces where the correlation of the images is at least this; "
      "other faces follow those around them. -1: all faces, as in the paper");
  options->Add(ours + "pairs_per_image", &refinement->pairs_per_image, {1},
               "[images] Images with which each image is paired");
  options->Add(ours + "final_pairs_per_face",
               &refinement->labeling.final_pairs_per_facet, {0},
               "[pairs] Image pairs per face in the last two iterations, which "
               "determine the remaining noise; the two before use a third as "
               "many. 0: omit these four, as in the paper");
  options->Add(
      ours + "remeshing", &refinement->remeshing,
      "Remesh before the last level into well-shaped faces, small where the "
      "surface is curved. 0: only subdivide large faces, as in the paper");
}

void AddAblationOptions(CommandOptions* options, RefinerOptions* refiner) {
  const std::string ours = kRefinementSection;
  FacetwiseRefinementOptions* const refinement = &refiner->refinement;
  PhotometricOptions* const photometric = &refinement->photometric;
  FacetLabelingOptions* const labeling = &refinement->labeling;
  options->SetGroup(OptionGroup::kAblations);
  options->Add(ours + "window", &refiner->window, {3, 15},
               "[px] Side of the compared windows; odd");
  options->Add(ours + "noise_variance", &photometric->noise_variance, kPositive,
               "[gray values^2] Variance of the image noise, for gray values "
               "of 0 to 255; higher down-weights windows without texture");
  options->Add(
      ours + "residual_floor", &photometric->residual_floor, kPositive,
      "Fraction of a window's variance that even the best match leaves "
      "unexplained. A large one weights all windows alike, as in the paper");
  options->Add(ours + "min_cosine", &photometric->min_cosine, {0, 0.99},
               "Ignore images where the cosine between face normal and viewing "
               "direction is below this");
  options->Add(ours + "occlusion_masking", &photometric->occlusion_masking,
               "Ignore pixels of a window beyond a jump in depth");
  options->AddWord(ours + "pair_selection", &labeling->pair_selection,
                   {{"facetwise", PairSelection::kFacetwise},
                    {"classical", PairSelection::kClassical}},
                   "Refine each face by its best image pairs, or by every pair "
                   "that sees it");
  options->Add(ours + "pairs_per_face", &labeling->pairs_per_facet, {1},
               "[pairs] Image pairs per face");
  options->Add(ours + "potts_weight", &labeling->potts_weight, kNotNegative,
               "Cost of different image pairs on neighboring faces; higher "
               "makes larger patches");
  options->AddWord(ours + "solver", &refinement->solver,
                   {{"gauss_newton", RefinementSolver::kGaussNewton},
                    {"descent", RefinementSolver::kDescent}},
                   "Move all vertices jointly, or each one along its gradient, "
                   "as in the paper");
  options->SetGroup(OptionGroup::kBasic);
}

void AddRunOptions(CommandOptions* options, RefinerOptions* refiner) {
  const std::string ours = kRefinementSection;
  options->AddWord(
      ours + "backend", &refiner->backend,
      {{"auto", Backend::kAuto}, {"cpu", Backend::kCpu}, {"gl", Backend::kGl}},
      "Processor or OpenGL 4.5. auto: OpenGL if there is a graphics card, else "
      "the processor");
  AddGpuIndexOption(&refiner->gpu_index, options);
  options->AddAlias(ours + "gpu_index", "gpu_index");
  options->AddThreads("FacetwiseRefinement");
  options->Add("max_memory_gb", &refiner->max_memory_gb,
               {kGigabytes.lower, kGigabytes.upper, kAutoMemory, "auto"},
               "[GB] Memory to keep to if the mesh allows it: images and what "
               "is drawn into them are kept in what the mesh leaves, and read "
               "and drawn again beyond that. auto: three quarters of the "
               "machine's");
}

}  // namespace

void RefinerOptions::Finish() {
  if (!plan_path.empty() || tile >= 0) {
    CheckPlan(*this);
  } else {
    CheckPaths(*this);
  }
  scene.Finish();
  FinishMethod();
}

void RefinerOptions::FinishMethod() {
  RefuseIf(window % 2 == 0, "FacetwiseRefinement.window must be odd");
  refinement.photometric.window_radius = window / 2;
  refinement.cameras.parts = refine_cameras.value_or(RefinedParts::kPoses);
  refinement.cameras.only_if_misaligned = !refine_cameras;
  ChooseTrim(true);
}

void RefinerOptions::ChooseTrim(bool has_fused_points) {
  // Tuned on photographs: membranes over the sky or an unseen basin have less,
  // and surface that two images see well has more (docs/method.md, 7.6).
  constexpr double kDefault = 0.15;
  BorderOptions& borders = refinement.borders;
  borders.is_trim_optional = min_confidence == kAutoTrim;
  borders.trim = !borders.is_trim_optional ? min_confidence
                 : has_fused_points        ? kDefault
                                           : 0;
}

fs::path RefinerOptions::StepsPath() const {
  return report_path == PagePath() ? WithExtension(report_path, ".csv")
                                   : fs::path(report_path);
}

fs::path RefinerOptions::PagePath() const {
  return WithExtension(report_path, ".html");
}

void AddResultOptions(CommandOptions* options, RefinerOptions* refiner) {
  AddBasicOptions(options, refiner);
  AddAdvancedOptions(options, refiner);
  AddAblationOptions(options, refiner);
}

void AddRefinerOptions(CommandOptions* options, RefinerOptions* refiner) {
  options->SetSummary(
      "Refines a mesh by the images of its workspace: moves the vertices so "
      "that the\nimages agree when projected onto the surface.",
      {"facetwise_refiner --workspace_path DIR"});
  AddPathOptions(options, refiner);
  AddRegionOption("Refine only inside, and remove the mesh outside of",
                  &refiner->scene.region, kWrittenAutoRegion, options);
  AddMaskOption(&refiner->scene.mask_path, options);
  AddTransformOption(&refiner->scene.transform_path, options);
  AddRunOptions(options, refiner);
  AddResultOptions(options, refiner);
}

}  // namespace colmap_ext
