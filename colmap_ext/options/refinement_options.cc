#include "colmap_ext/options/refinement_options.h"

#include "colmap_ext/errors.h"
#include "colmap_ext/options/image_order_option.h"
#include "colmap_ext/options/words.h"

namespace colmap_ext {

namespace {

namespace fs = std::filesystem;

constexpr const char* kRefinerOutput = "meshed-refined.ply";

// A pixel takes a byte in an image, and eight where facets are drawn.
constexpr double kImageShare = 1.0 / 9;

// What drawings are left with at least where images take more, of all: some
// views and their partners, a choice.
constexpr double kMinDrawingShare = 0.25;

void CheckPaths(const RefinerOptions& options) {
  if (options.workspace_path.empty()) {
    throw OptionError("--workspace_path is required");
  }
  if (!options.input_path.empty() && options.output_path.empty()) {
    throw OptionError("--output_path is required with --input_path");
  }
  if (options.PlotPath() == options.report_path &&
      !options.report_path.empty()) {
    throw OptionError(
        "--report_path is a CSV or a page, .html, and the plot beside it ends "
        "in .svg");
  }
  if (options.LabelsPicturePath() == options.labels_path &&
      !options.labels_path.empty()) {
    throw OptionError(
        "--labels_path is a PLY, and the picture beside it ends in .png");
  }
}

// A plan says what is refined.
void CheckPlan(const RefinerOptions& options) {
  if (options.plan_path.empty()) {
    throw OptionError("--tile needs --plan");
  }
  for (const std::string* path :
       {&options.workspace_path, &options.output_path, &options.fused_path,
        &options.sparse_path, &options.report_path, &options.labels_path,
        &options.scene.mask_path, &options.scene.transform_path,
        &options.scene.region.text}) {
    if (!path->empty()) {
      throw OptionError(
          "--plan says what is refined: of the paths, leave out all but "
          "--input_path, and masks, regions and transforms");
    }
  }
  if (options.resume || options.viewer || options.snapshot_interval > 0) {
    throw OptionError(
        "--resume, --viewer and snapshot_interval are not for plans: a tile is "
        "refined at one go");
  }
  if (options.input_path.empty() != (options.tile >= 0)) {
    throw OptionError(
        options.tile >= 0
            ? "--input_path is for the planning, without --tile"
            : "--plan needs --tile, or --input_path, the plan's mesh, to plan "
              "its refinement");
  }
  if (options.words.refine_cameras != "auto" &&
      options.words.refine_cameras != "none") {
    throw OptionError(
        "cameras are not refined in tiles: refine them before, without --plan, "
        "and plan by mesh_planner --sparse_path WORKSPACE/sparse-refined");
  }
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
  if (window % 2 == 0) {
    throw OptionError("FacetwiseRefinement.window must be odd");
  }
  image_order = ParseImageOrder(words.image_order);
  backend = ParseWord<Backend>(
      "backend", words.backend,
      {{"auto", Backend::kAuto}, {"cpu", Backend::kCpu}, {"gl", Backend::kGl}});
  refinement.photometric.window_radius = window / 2;
  refinement.labeling.pair_selection =
      ParseWord<PairSelection>("pair_selection", words.pair_selection,
                               {{"facetwise", PairSelection::kFacetwise},
                                {"classical", PairSelection::kClassical}});
  refinement.solver = ParseWord<RefinementSolver>(
      "solver", words.solver,
      {{"gauss_newton", RefinementSolver::kGaussNewton},
       {"descent", RefinementSolver::kDescent}});
  refinement.cameras.parts = ParseWord<RefinedParts>(
      "refine_cameras", words.refine_cameras,
      {{"auto", RefinedParts::kPoses},
       {"none", RefinedParts::kNothing},
       {"poses", RefinedParts::kPoses},
       {"poses_intrinsics", RefinedParts::kPosesIntrinsics}});
  refinement.cameras.only_if_misaligned = words.refine_cameras == "auto";
  ChooseTrim(true);
}

void RefinerOptions::ChooseTrim(bool has_fused_points) {
  // Found on photographs: what spans the sky or an unseen basin has less, and
  // what two images see well has more (docs/method.md, section 7.6).
  constexpr double kDefault = 0.2;
  BorderOptions& borders = refinement.borders;
  borders.is_trim_optional = trim == kAutoTrim;
  borders.trim =
      borders.is_trim_optional ? (has_fused_points ? kDefault : 0) : trim;
}

fs::path RefinerOptions::OutputPath(const fs::path& folder) const {
  return output_path.empty() ? folder / kRefinerOutput : fs::path(output_path);
}

fs::path RefinerOptions::StepsPath() const {
  const fs::path path = report_path;
  return path == PagePath() ? fs::path(path).replace_extension(".csv") : path;
}

fs::path RefinerOptions::PlotPath() const {
  return fs::path(report_path).replace_extension(".svg");
}

fs::path RefinerOptions::PagePath() const {
  return fs::path(report_path).replace_extension(".html");
}

fs::path RefinerOptions::LabelsPicturePath() const {
  return fs::path(labels_path).replace_extension(".png");
}

size_t RefinerOptions::MaxImageMemory() const {
  return static_cast<size_t>(kImageShare * 1e9 * max_memory_gb);
}

size_t RefinerOptions::MaxDrawingMemory() const {
  return static_cast<size_t>((1 - kImageShare) * 1e9 * max_memory_gb);
}

size_t RefinerOptions::MaxMemoryLentToImages() const {
  return static_cast<size_t>((1 - kImageShare - kMinDrawingShare) * 1e9 *
                             max_memory_gb);
}

}  // namespace colmap_ext
