#include <limits>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "colmap_ext/report/evaluation_report.h"

namespace colmap_ext {
namespace evaluation_json_test {

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

}  // namespace evaluation_json_test
}  // namespace colmap_ext
