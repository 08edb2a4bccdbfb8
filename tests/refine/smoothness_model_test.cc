#include "refine/smoothness_model.h"

#include <cmath>

#include <gtest/gtest.h>

#include "mesh/normals.h"
#include "refine/thin_plate.h"
#include "tests/mesh/shapes.h"

namespace colmap_ext {
namespace smoothness_model_test {

// By a view at the origin, along z, and one that is two units farther back.
TEST(VertexFootprints, AreOfTheViewsThatAVertexLiesBefore) {
  View view;
  view.fx = view.fy = 100;
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
    FacetTerms terms;
    terms.curvatures = {2, 1, 1, 2, 1, 2};
    surface.terms.facets.assign(num_facets, terms);
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
    size_t num_unconverged = 0;
    SmoothnessTarget target =
        EstimateWeights(domain, surface, model, 1, &num_unconverged);
    EXPECT_EQ(num_unconverged, 0);
    return target;
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
  ExpectInAgreement(scene, model);
  model = scene.Model(ConfirmRelief(scene.domain, model));
  ExpectInAgreement(scene, model);
  model = scene.Model(scene.Estimate(model));
  ExpectInAgreement(scene, model);
  model = scene.Model(ConfirmRelief(scene.domain, model));
  ExpectInAgreement(scene, model);
}

TEST(SmoothnessModel, KeepsTheReliefOfCoarseLevelsAndOfWhatIsNotSeen) {
  for (const bool is_finest : {false, true}) {
    const Scene scene(is_finest);
    const SmoothnessModel model = scene.First();
    for (size_t i = 0; i < scene.domain.is_seen.size(); ++i) {
      if (scene.domain.rings.is_border[i] != 0) {
        continue;
      }
      if (is_finest && scene.domain.is_seen[i] != 0) {
        EXPECT_EQ(model.target.relief[i], 0);
      } else {
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
  const SmoothnessModel first = scene.First();
  const SmoothnessTarget once = ConfirmRelief(scene.domain, first);
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

}  // namespace smoothness_model_test
}  // namespace colmap_ext
