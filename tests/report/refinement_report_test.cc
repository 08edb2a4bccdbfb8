#include "colmap_ext/report/print_report.h"

#include <limits>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/texts.h"

namespace colmap_ext {
namespace refinement_report_test {

// Two iterations at half size, one and a final one at full size.
std::vector<RefinementStep> Steps() {
  std::vector<RefinementStep> steps(4);
  steps[0].level = steps[1].level = 1;
  steps[1].iteration = 1;
  steps[1].energy = -1.0 / 3;
  steps[1].mean_zncc = 0.5;
  steps[1].mean_step = 0.25;
  steps[1].seconds = 1.5;
  steps[1].num_vertices = 10;
  steps[1].num_facets = 16;
  steps[3].is_final = true;
  steps[3].iteration = 1;
  steps[3].num_pairs = 18;
  return steps;
}

TEST(RefinementReportTest, WritesARowAnIteration) {
  EXPECT_EQ(StepsCsv(Steps()),
            "level,final,iteration,energy,photometric_energy,mean_zncc,"
            "mean_step_px,seconds,vertices,faces,pairs\n"
            "1,0,0,0,0,0,0,0.000,0,0,0\n"
            "1,0,1,-0.333333333,0,0.5,0.25,1.500,10,16,0\n"
            "0,0,0,0,0,0,0,0.000,0,0,0\n"
            "0,1,1,0,0,0,0,0.000,0,0,18\n");
}

TEST(RefinementReportTest, SplitsIterationsIntoStages) {
  const auto stages = SplitIntoStages(Steps());
  ASSERT_EQ(stages.size(), 3);
  EXPECT_EQ(stages[0].size(), 2);
  EXPECT_EQ(StageName(stages[0][0]), "1/2 size");
  EXPECT_EQ(StageName(stages[2][0]), "full size, final, 18 pairs");
  EXPECT_EQ(Describe(Steps()[1]),
            "1/2 size, iteration 1: energy -0.333333, ZNCC 0.5000, step 0.250 "
            "px");
}

TEST(RefinementReportTest, DescribesStagesFromTheirFirstToTheirLastStep) {
  const std::vector<StageText> stages = DescribeStages(Steps());
  ASSERT_EQ(stages.size(), 3);
  EXPECT_EQ(stages[0].name, "1/2 size");
  EXPECT_EQ(stages[0].iterations, "1");
  EXPECT_EQ(stages[0].faces, "16");
  EXPECT_EQ(stages[0].energy[0], "0");
  EXPECT_EQ(stages[0].energy[1], "-0.333333");
  EXPECT_EQ(stages[0].mean_zncc[0], "0.0000");
  EXPECT_EQ(stages[0].mean_zncc[1], "0.5000");
}

TEST(RefinementReportTest, PlotsAPanelAStage) {
  const std::string plot = StepsPlot(Steps());
  EXPECT_TRUE(plot.starts_with("<svg "));
  EXPECT_TRUE(plot.ends_with("</svg>\n"));
  EXPECT_EQ(Count(plot, "<polyline"), 3);
  EXPECT_TRUE(StepsPlot({}).ends_with("</svg>\n"));
}

TEST(RefinementReportTest, PlotsOtherValuesForPages) {
  const std::string figure = StepsFigure(Steps(), StepValue::kMeanZncc);
  EXPECT_TRUE(figure.starts_with("<svg role="));
  EXPECT_TRUE(HasAll(figure, {"Mean ZNCC", ">0.5000<"}));
  EXPECT_FALSE(Has(figure, "http"));
}

TEST(PrintLinesTest, AlignsNumbersAndKeepsWhatIsPrinted) {
  std::ostringstream stream;
  ReportLog log(&stream);
  Print("faces", 12, &log);
  PrintIfAny("none", 0, &log);
  PrintHeading("Heading", &log);
  PrintText("label", "text", &log);
  PrintWarning("what", &log);
  EXPECT_EQ(stream.str(),
            "  faces                                             12\n"
            "\nHeading\n"
            "  label                                 text\n"
            "WARNING: what\n");
  ASSERT_EQ(log.sections.size(), 2);
  EXPECT_EQ(log.sections[0].heading, "");
  EXPECT_EQ(log.sections[1].heading, "Heading");
  ASSERT_EQ(log.sections[1].rows.size(), 1);
  EXPECT_EQ(log.sections[1].rows[0].label, "label");
  EXPECT_EQ(log.sections[1].rows[0].text, "text");
  EXPECT_EQ(log.warnings, std::vector<std::string>{"what"});
}

TEST(EvaluationJsonTest, HasNineDigitsAndNullForWhatIsNotFinite) {
  EvaluatorOptions options;
  options.mesh_path = "a \"mesh\"\n\xff.ply";
  MeshEvaluation evaluation;
  evaluation.num_views = 7;
  evaluation.distances.emplace();
  evaluation.distances->max_distance = 20;
  evaluation.distances->spacing = 1.0 / 3;
  evaluation.distances->accuracy.mean =
      std::numeric_limits<double>::quiet_NaN();
  evaluation.distances->accuracy.num_samples = size_t{1} << 60;
  const auto json = nlohmann::json::parse(EvaluationJson(options, evaluation));
  EXPECT_EQ(json["mesh_path"], "a \"mesh\"\n\xef\xbf\xbd.ply");
  EXPECT_EQ(json["num_images"], 7);
  EXPECT_EQ(json["max_distance"], 20);
  EXPECT_EQ(json["spacing"], 0.333333333);
  EXPECT_TRUE(json["accuracy"]["mean"].is_null());
  EXPECT_EQ(json["accuracy"]["num_samples"], size_t{1} << 60);
  EXPECT_TRUE(json["depths"].is_null());
}

TEST(EvaluationJsonTest, KeepsTheOrderOfItsKeys) {
  const EvaluatorOptions options;
  const MeshEvaluation evaluation;
  const std::string text = EvaluationJson(options, evaluation);
  size_t position = 0;
  for (const char* key :
       {"mesh_path", "truth_path", "workspace_path", "stride", "beyond",
        "num_images", "max_distance", "spacing", "accuracy", "completeness",
        "average_score", "depths", "topology", "is_manifold", "genus"}) {
    const size_t found = text.find("\"" + std::string(key) + "\": ", position);
    ASSERT_NE(found, std::string::npos) << key;
    position = found;
  }
  EXPECT_TRUE(text.ends_with("}\n"));
}

}  // namespace refinement_report_test
}  // namespace colmap_ext
