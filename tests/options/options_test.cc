#include <algorithm>
#include <functional>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "colmap_ext/options/evaluation_options.h"
#include "colmap_ext/options/meshing_options.h"
#include "colmap_ext/options/refinement_options.h"
#include "colmap_ext/options/viewer_options.h"
#include "tests/texts.h"

namespace colmap_ext::options_test {

// Fails unless the options are refused with a message that has the text.
template <typename Options>
void ExpectRefused(Options* options, const std::string& text) {
  EXPECT_TRUE(Has(MessageOf<OptionError>([&] { options->Finish(); }), text));
}

// The same for sound options after a change.
void ExpectChangeRefused(const std::function<void(RefinerOptions*)>& change,
                         const std::string& text) {
  RefinerOptions options;
  options.workspace_path = "workspace";
  change(&options);
  ExpectRefused(&options, text);
}

using R = RefinerOptions;

TEST(RegionOptionTest, IsAutoCornersOrAFile) {
  RegionOption option;
  option.Finish();
  EXPECT_FALSE(option.Resolve({}, {}));
  option.text = "0,0,0,1,2,3";
  option.Finish();
  EXPECT_EQ(option.Resolve({}, {})->half_sizes, Eigen::Vector3d(0.5, 1, 1.5));
  option.text = "auto";
  option.Finish();
  EXPECT_THROW(option.Resolve({}, {}), OptionError);
  EXPECT_EQ(option.FoundPath("a/mesh.ply"), "a/mesh.region.txt");
  option.text = "0,0,0,1,2";
  ExpectRefused(&option, "--region");
  option.text = "no such file";
  ExpectRefused(&option, "no such file");
  EXPECT_EQ(option.FoundPath("a/mesh.ply"), "");
}

TEST(RefinerOptionsTest, SetsWhatDependsOnOtherOptions) {
  R options;
  options.workspace_path = "workspace";
  options.Finish();
  EXPECT_EQ(options.backend, Backend::kAuto);
  EXPECT_FALSE(options.image_order);
  EXPECT_EQ(options.refinement.solver, RefinementSolver::kGaussNewton);
  EXPECT_EQ(options.refinement.photometric.window_radius, 2);
  EXPECT_EQ(options.refinement.cameras.parts, RefinedParts::kPoses);
  EXPECT_TRUE(options.refinement.cameras.only_if_misaligned);
  CommandOptions command;
  AddRefinerOptions(&command, &options);
  for (const auto& [name, word] :
       {std::pair("pair_selection", "classical"),
        std::pair("solver", "descent"),
        std::pair("refine_cameras", "poses_intrinsics"),
        std::pair("backend", "gl"), std::pair("image_order", "frame_id")}) {
    const auto option = std::ranges::find_if(
        command.Options(), [name = std::string(name)](const auto& candidate) {
          return candidate.name == name || candidate.name.ends_with("." + name);
        });
    ASSERT_NE(option, command.Options().end()) << name;
    EXPECT_TRUE(option->set(word));
    EXPECT_EQ(option->text(), word);
    EXPECT_FALSE(option->set("magic"));
  }
  options.window = 7;
  options.Finish();
  EXPECT_EQ(options.refinement.labeling.pair_selection,
            PairSelection::kClassical);
  EXPECT_EQ(options.refinement.solver, RefinementSolver::kDescent);
  EXPECT_EQ(options.refinement.cameras.parts, RefinedParts::kPosesIntrinsics);
  EXPECT_FALSE(options.refinement.cameras.only_if_misaligned);
  EXPECT_EQ(options.backend, Backend::kGl);
  EXPECT_EQ(options.image_order, ImageOrderKind::kFrameId);
  EXPECT_EQ(options.refinement.photometric.window_radius, 3);
}

// By itself the refiner trims only what fused points can tell of.
TEST(RefinerOptionsTest, ChoosesTheTrimming) {
  R options;
  options.workspace_path = "workspace";
  options.Finish();
  const BorderOptions& borders = options.refinement.borders;
  EXPECT_GT(borders.trim, 0);
  EXPECT_TRUE(borders.is_trim_optional);
  options.ChooseTrim(false);
  EXPECT_EQ(borders.trim, 0);
  for (const double trim : {0.0, 0.7}) {
    options.min_confidence = trim;
    for (const bool has_fused_points : {true, false}) {
      options.ChooseTrim(has_fused_points);
      EXPECT_EQ(borders.trim, trim);
      EXPECT_FALSE(borders.is_trim_optional);
    }
  }
}

TEST(RefinerOptionsTest, RefusesImpossiblePathsAndEvenWindows) {
  R none;
  ExpectRefused(&none, "--workspace_path is required");
  ExpectChangeRefused([](R* o) { o->input_path = "a"; }, "--output_path");
  ExpectChangeRefused([](R* o) { o->window = 4; }, "window must be odd");
}

TEST(RefinerOptionsTest, NamesTheReportsFilesAlike) {
  for (const char* path : {"a b/c.d.csv", "a b/c.d.html"}) {
    R options;
    options.report_path = path;
    EXPECT_EQ(options.StepsPath(), "a b/c.d.csv");
    EXPECT_EQ(options.PagePath(), "a b/c.d.html");
  }
  R options;
  options.report_path = "steps.txt";
  EXPECT_EQ(options.StepsPath(), "steps.txt");
}

TEST(MesherOptionsTest, ChecksItsOptions) {
  MesherOptions options;
  ExpectRefused(&options, "--workspace_path or --input_path");
  options.input_path = "in";
  ExpectRefused(&options, "--output_path is required");
  options.output_path = "out";
  options.Finish();
  EXPECT_EQ(options.meshing.alpha_kind, ObservationWeight::kTracks);
  options.workspace.input_type = InputType::kSparse;
  options.workspace.fused_path = "fused.ply";
  ExpectRefused(&options, "--fused_path is for dense input");
  MesherOptions constant;
  constant.workspace_path = "workspace";
  constant.alpha_vis = 0.5;
  constant.Finish();
  EXPECT_EQ(constant.meshing.alpha_kind, ObservationWeight::kConstant);
  EXPECT_EQ(constant.meshing.alpha_vis, 0.5);
}

TEST(EvaluatorOptionsTest, ChecksItsOptions) {
  EvaluatorOptions options;
  ExpectRefused(&options, "--mesh_path and --truth_path are required");
  options.mesh_path = options.truth_path = "a";
  options.depth_thresholds = "0.5,2";
  options.Finish();
  EXPECT_EQ(options.evaluation.depth_thresholds, (std::vector<double>{0.5, 2}));
  options.depth_thresholds = "1,x";
  ExpectRefused(&options, "depth_thresholds");
  options.depth_thresholds = "1";
  options.image_name = "x";
  ExpectRefused(&options, "--image_name");
  options.image_name = "";
  options.observability_box = "1,2,3,4";
  ExpectRefused(&options, "--observability_mask");
  options.observability_box = "";
  for (const char* thresholds : {"1,0", "-1", "inf", "1e999", ""}) {
    options.depth_thresholds = thresholds;
    ExpectRefused(&options, "depth_thresholds");
  }
  options.ground_plane = "1,2";
  EXPECT_THROW(options.ReadObservability(), OptionError);
}

TEST(ViewerOptionsTest, ACenterIsTwoFiniteNumbers) {
  ViewerOptions options;
  options.workspace_path = "workspace";
  options.center_words = "0.25,-1";
  options.Finish();
  EXPECT_EQ(options.center_u, 0.25);
  EXPECT_EQ(options.center_v, -1);
  for (const char* center : {"", "1", "1,2,3", "inf,0", "0,nan", "0,1e999"}) {
    options.center_words = center;
    ExpectRefused(&options, "center is '" + std::string(center) + "'");
  }
}

}  // namespace colmap_ext::options_test
