#include "refine/smoothness_model.h"

#include <cmath>

#include <gtest/gtest.h>

#include "mesh/normals.h"
#include "tests/mesh/known_meshes.h"
#include "tests/threads.h"

namespace colmap_ext::smoothness_model_test {

// By a view at the origin, along z, and one that is two units farther back.
TEST(VertexFootprints, AreOfTheViewsThatAVertexLiesBefore) {
  const View view{"", 0, 0, 100, 100};
  View behind = view;
  behind.cam_from_world_translation.z() = 2;
  const TriangleMesh mesh = {{{0, 0, 4}, {1, 0, 2}, {0, 1, -1}}, {{0, 1, 2}}};
  EXPECT_EQ(VertexFootprints(mesh, MakeVertexRings(mesh),
                             {{{0, 1}}, {{0, 1}, {0}}, {}}, {view, behind}),
            (std::vector<float>{0.05F, 0.03F, 0.01F}));
}

constexpr float kFootprint = 0.02f;  // scene units

// A bumpy cap of which one half is seen, with curvatures that determine it.
struct Scene {
  explicit Scene(bool is_finest) {
    surface.mesh = MakeBumpyCap(0.1f);
    domain.rings = MakeVertexRings(surface.mesh);
    surface.normals = VertexNormals(surface.mesh, domain.rings);
    const size_t num_facets = surface.mesh.facets.size();
    surface.terms.facets.assign(num_facets, {.curvatures = {2, 1, 1, 2, 1, 2}});
    const size_t size = surface.mesh.vertices.size();
    domain.footprints.assign(size, kFootprint);
    domain.num_pixels.assign(size, 5);
    for (const Eigen::Vector3f& vertex : surface.mesh.vertices) {
      domain.is_seen.push_back(vertex.x() > 0 ? 1 : 0);
    }
    if (is_finest) {
      domain.trusted_relief =
          TrustedRelief(surface.mesh, domain.rings, domain.footprints);
      for (size_t i = 0; i < size; ++i) {
        domain.trusted_relief[i] *= domain.is_seen[i];
      }
    }
  }

  SmoothnessModel First() const {
    return Model(FirstTarget(domain, surface.mesh, 20));
  }

  SmoothnessModel Model(SmoothnessTarget target) const {
    return MakeSmoothnessModel(std::move(target), domain, surface);
  }

  SmoothnessTarget Estimate(const SmoothnessModel& model) const {
    return EstimateWeights(domain, surface, model, 1);
  }

  EvaluatedSurface surface;
  SmoothnessDomain domain;
};

// What a model says of the surface's own relief does not depend on the target:
// a plate made for another target would show here.
void ExpectInAgreement(const Scene& scene, const SmoothnessModel& model) {
  const std::vector<double> relief =
      Relief(scene.surface.mesh, scene.domain.rings, scene.domain.footprints);
  for (size_t i = 0; i < relief.size(); ++i) {
    if (scene.domain.rings.is_border[i] == 0) {
      EXPECT_NEAR(model.plate.residuals[i] + model.target.relief[i], relief[i],
                  1e-12);
    }
  }
}

TEST(SmoothnessModel, AgreesWithTheSurfaceAfterEachStep) {
  const Scene scene(/*is_finest=*/true);
  SmoothnessModel model = scene.First();
  for (int round = 0; round < 2; ++round) {
    ExpectInAgreement(scene, model);
    model = scene.Model(ConfirmRelief(scene.domain, model));
    ExpectInAgreement(scene, model);
    model = scene.Model(scene.Estimate(model));
  }
}

TEST(SmoothnessModel, KeepsTheReliefOfCoarseLevelsAndOfWhatIsNotSeen) {
  for (const bool is_finest : {false, true}) {
    const Scene scene(is_finest);
    const SmoothnessModel model = scene.First();
    for (size_t i = 0; i < scene.domain.is_seen.size(); ++i) {
      if (is_finest && scene.domain.is_seen[i] != 0) {
        EXPECT_EQ(model.target.relief[i], 0);
      } else if (scene.domain.rings.is_border[i] == 0) {
        EXPECT_NEAR(model.plate.residuals[i], 0, 1e-12);
      }
    }
  }
}

// The surface is the one that the trusted relief is of.
TEST(ConfirmRelief, FindsTheReliefThatTheSurfaceHas) {
  const Scene scene(/*is_finest=*/true);
  const SmoothnessModel model = scene.First();
  const SmoothnessTarget target = ConfirmRelief(scene.domain, model);
  double confirmed = 0;
  double trusted = 0;
  for (size_t i = 0; i < target.relief.size(); ++i) {
    if (scene.domain.is_seen[i] != 0) {
      confirmed += std::abs(target.relief[i]);
      trusted += std::abs(scene.domain.trusted_relief[i]);
    } else {
      EXPECT_EQ(target.relief[i], model.target.relief[i]);
    }
  }
  EXPECT_GT(confirmed, 0.7 * trusted);
}

TEST(ConfirmRelief, DoesNotDependOnWhatWasConfirmedBefore) {
  const Scene scene(/*is_finest=*/true);
  const SmoothnessTarget once = ConfirmRelief(scene.domain, scene.First());
  const SmoothnessTarget twice = ConfirmRelief(scene.domain, scene.Model(once));
  for (size_t i = 0; i < once.relief.size(); ++i) {
    EXPECT_NEAR(once.relief[i], twice.relief[i],
                1e-9 * std::abs(once.relief[i]));
  }
}

// Half of the squared relief that is confirmed counts as rough: where all of a
// surface's relief is, the weight is twice that without.
TEST(EstimateWeights, CountsHalfOfTheConfirmedReliefAsRough) {
  Scene scene(/*is_finest=*/true);
  scene.domain.is_seen.assign(scene.domain.is_seen.size(), 1);
  const std::vector<double> relief =
      Relief(scene.surface.mesh, scene.domain.rings, scene.domain.footprints);
  SmoothnessTarget none = FirstTarget(scene.domain, scene.surface.mesh, 1);
  // A weight near the estimate, or the change is limited.
  for (int i = 0; i < 10; ++i) {
    none = scene.Estimate(scene.Model(std::move(none)));
  }
  none.weights.assign(relief.size(), none.weight);
  SmoothnessTarget all = none;
  all.relief = relief;
  EXPECT_NEAR(scene.Estimate(scene.Model(all)).weight,
              2 * scene.Estimate(scene.Model(none)).weight, 1e-6 * none.weight);
}

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
    if (std::abs(x - kMiddle) > 4) {
      // All that the weight of the whole changes is 1 / 501 of it.
      const double own = x < kMiddle ? 10 : 20;
      EXPECT_NEAR(1 / weights[i], (1 / own + 0.002 / weight) / 1.002, 1e-6);
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
                    [](float x) { return x < kMiddle / 4 ? 1e-4 : 1e4; });
  const std::vector<double> weights = sheet.Weights();
  const double weight = GlobalWeight(sheet.evidence);
  for (size_t i = 0; i < weights.size(); ++i) {
    const float x = sheet.mesh.vertices[i].x();
    if (x < kMiddle / 4 - 4) {
      EXPECT_EQ(weights[i], 0.7 * weight);
    } else if (x > kMiddle / 4 + 4) {
      EXPECT_EQ(weights[i], 256 * weight);
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
  std::vector<double> weights = sheet.Weights();
  std::ranges::sort(weights);
  EXPECT_NEAR(weights[weights.size() / 20], 7, 4);
  EXPECT_NEAR(weights[weights.size() * 19 / 20], 7, 4);
  EXPECT_GT(weights.front(), 1);
  EXPECT_LT(weights.back(), 21);
}

TEST(SmoothnessWeights, StandInProportionToTheEvidence) {
  const Sheet sheet([](float) { return 0.4; },
                    [](float x) { return x < kMiddle ? 10.0 : 20.0; });
  Sheet scaled = sheet;
  for (double& roughness : scaled.evidence.roughness) {
    roughness *= 1024;
  }
  std::vector<double> weights = scaled.Weights();
  for (double& weight : weights) {
    weight *= 1024;
  }
  EXPECT_EQ(weights, sheet.Weights());
}

// And without a limit if it is flat.
TEST(SmoothnessWeights, AreThatOfAllWithoutAnyEvidence) {
  EXPECT_TRUE(std::isinf(GlobalWeight({{0.5, 0.5}, {0, 0}})));
  const Sheet sheet([](float) { return 0.0; }, [](float) { return 1.0; });
  EXPECT_EQ(LocalWeights(sheet.rings, sheet.evidence, 3),
            std::vector<double>(sheet.mesh.vertices.size(), 3));
}

TEST(SmoothnessWeights, DoNotDependOnThreads) {
  const Sheet sheet([](float x) { return 0.1 + std::sin(x); },
                    [](float x) { return 2 + std::cos(x); });
  ExpectSameForAnyThreads([&] { return sheet.Weights(); });
}

}  // namespace colmap_ext::smoothness_model_test
