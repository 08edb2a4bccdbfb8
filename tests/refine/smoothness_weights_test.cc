#include "refine/smoothness_weights.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/mesh/known_meshes.h"
#include "tests/threads.h"

namespace colmap_ext {
namespace smoothness_weights_test {

constexpr uint32_t kSide = 80;
constexpr float kMiddle = 40;

// A sheet whose vertices have x from 0 to kSide, and what they are told by
// functions of x.
struct Sheet {
  template <typename Determined, typename Weight>
  Sheet(const Determined& determined, const Weight& weight)
      : mesh(MakeSheet(kSide, kSide)), rings(MakeVertexRings(mesh)) {
    for (size_t i = 0; i < mesh.vertices.size(); ++i) {
      const float x = mesh.vertices[i].x();
      evidence.determined.push_back(determined(x));
      evidence.roughness.push_back(determined(x) / weight(x));
    }
  }

  std::vector<double> Weights() const {
    return LocalWeights(rings, evidence, GlobalWeight(evidence));
  }

  TriangleMesh mesh;
  VertexRings rings;
  SmoothnessEvidence evidence;
};

TEST(SmoothnessWeights, AreTheSameOfASurfaceThatIsTheSameEverywhere) {
  const Sheet sheet([](float) { return 0.4; }, [](float) { return 7.0; });
  EXPECT_NEAR(GlobalWeight(sheet.evidence), 7, 1e-9);
  for (const double weight : sheet.Weights()) {
    EXPECT_NEAR(weight, 7, 1e-9);
  }
}

TEST(SmoothnessWeights, AreThoseOfEachPart) {
  const Sheet sheet([](float) { return 0.4; },
                    [](float x) { return x < kMiddle ? 10.0 : 20.0; });
  const std::vector<double> weights = sheet.Weights();
  const double weight = GlobalWeight(sheet.evidence);
  EXPECT_GT(weight, 10);
  EXPECT_LT(weight, 20);
  for (size_t i = 0; i < weights.size(); ++i) {
    const float x = sheet.mesh.vertices[i].x();
    if (std::abs(x - kMiddle) > 10) {
      // All that the weight of the whole changes is 1 / 11 of it.
      const double own = x < kMiddle ? 10 : 20;
      EXPECT_NEAR(1 / weights[i], (1 / own + 0.1 / weight) / 1.1, 1e-6);
    }
    EXPECT_GE(weights[i], 10);
    EXPECT_LE(weights[i], 20);
  }
}

TEST(SmoothnessWeights, AreThatOfAllWhereNothingIsDetermined) {
  const Sheet sheet([](float x) { return x < kMiddle ? 0.4 : 0.0; },
                    [](float x) { return x < kMiddle / 2 ? 5.0 : 20.0; });
  const std::vector<double> weights = sheet.Weights();
  const double weight = GlobalWeight(sheet.evidence);
  for (size_t i = 0; i < weights.size(); ++i) {
    if (sheet.mesh.vertices[i].x() > kMiddle + 10) {
      EXPECT_NEAR(weights[i], weight, 1e-9 * weight);
    }
  }
}

TEST(SmoothnessWeights, DoNotStrayFarFromThatOfAll) {
  const Sheet sheet([](float) { return 0.4; },
                    [](float x) { return x < kMiddle / 2 ? 1e-4 : 1e4; });
  const std::vector<double> weights = sheet.Weights();
  const double weight = GlobalWeight(sheet.evidence);
  for (size_t i = 0; i < weights.size(); ++i) {
    const float x = sheet.mesh.vertices[i].x();
    if (x < kMiddle / 2 - 10) {
      EXPECT_EQ(weights[i], 0.5 * weight);
    } else if (x > kMiddle / 2 + 11) {
      EXPECT_GT(weights[i], 10 * weight);
      EXPECT_LE(weights[i], 16 * weight);
    }
  }
}

// Single vertices are estimated with much noise.
TEST(SmoothnessWeights, DoNotFollowTheNoiseOfTheEvidence) {
  Random random(1);
  Sheet sheet([](float) { return 0.4; }, [](float) { return 7.0; });
  for (double& determined : sheet.evidence.determined) {
    determined += 2 * random.Unit() - 1;
  }
  for (double& roughness : sheet.evidence.roughness) {
    roughness *= 2 * random.Unit();
  }
  for (const double weight : sheet.Weights()) {
    EXPECT_NEAR(weight, 7, 4);
  }
}

TEST(SmoothnessWeights, StandInProportionToTheEvidence) {
  const Sheet sheet([](float) { return 0.4; },
                    [](float x) { return x < kMiddle ? 10.0 : 20.0; });
  Sheet scaled = sheet;
  for (double& roughness : scaled.evidence.roughness) {
    roughness *= 1024;
  }
  const std::vector<double> weights = sheet.Weights();
  const std::vector<double> small_weights = scaled.Weights();
  for (size_t i = 0; i < weights.size(); ++i) {
    EXPECT_EQ(small_weights[i], weights[i] / 1024);
  }
}

TEST(SmoothnessWeights, OfAFlatSurfaceHaveNoLimit) {
  const SmoothnessEvidence evidence{{0.5, 0.5}, {0, 0}};
  EXPECT_TRUE(std::isinf(GlobalWeight(evidence)));
}

TEST(SmoothnessWeights, AreThatOfAllWithoutAnyEvidence) {
  const Sheet sheet([](float) { return 0.0; }, [](float) { return 1.0; });
  EXPECT_EQ(LocalWeights(sheet.rings, sheet.evidence, 3),
            std::vector<double>(sheet.mesh.vertices.size(), 3));
}

TEST(SmoothnessWeights, DoNotDependOnThreads) {
  const Sheet sheet([](float x) { return 0.1 + std::sin(x); },
                    [](float x) { return 2 + std::cos(x); });
  ExpectSameForAnyThreads([&] { return sheet.Weights(); });
}

}  // namespace smoothness_weights_test
}  // namespace colmap_ext
