#include "remesh/edge_length_field.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "remesh/isotropic_remeshing.h"
#include "tests/mesh/shapes.h"
#include "tests/remesh/mesh_measures.h"

namespace colmap_ext {
namespace edge_length_field_test {

std::vector<float> Everywhere(const TriangleMesh& mesh, float value) {
  return std::vector<float>(mesh.vertices.size(), value);
}

// On a sphere the facets' middles stray by the tolerance.
TEST(LengthsForCurvature, KeepToTheToleranceOnASphere) {
  const TriangleMesh sphere = MakeBumpySphere(0.04F, 0);
  for (const float tolerance : {0.002F, 0.008F}) {
    std::vector<float> lengths =
        LengthsForCurvature(sphere, Everywhere(sphere, tolerance));
    const float exact = std::sqrt(6 * tolerance - 3 * tolerance * tolerance);
    for (const float length : lengths) {
      EXPECT_NEAR(length / exact, 1, 0.25);
    }
    LimitGradation(sphere, kGradation, &lengths);
    const TriangleMesh remeshed =
        RemeshIsotropically(sphere, lengths, TolerancesOf(lengths)).mesh;
    EXPECT_LT(remeshed.facets.size(), sphere.facets.size());
    EXPECT_LT(Distance(remeshed, sphere), 1.8 * tolerance);
    EXPECT_GT(Distance(remeshed, sphere), 0.8 * tolerance);
  }
}

TEST(LengthsForCurvature, AreInfiniteWhereNothingBoundsThem) {
  const TriangleMesh sheet = MakeSheet(5, 5);
  EXPECT_EQ(LengthsForCurvature(sheet, Everywhere(sheet, 0.01F)),
            Everywhere(sheet, INFINITY));
  const TriangleMesh sphere = MakeBumpySphere(0.2F);
  EXPECT_EQ(LengthsForCurvature(sphere, Everywhere(sphere, INFINITY)),
            Everywhere(sphere, INFINITY));
}

TEST(LengthsForCurvature, GrowWithTheScene) {
  const TriangleMesh mesh = MakeBumpySphere(0.1F);
  const std::vector<float> lengths =
      LengthsForCurvature(mesh, Everywhere(mesh, 0.01F));
  const std::vector<float> larger =
      LengthsForCurvature(Moved(mesh, [](const auto& p) { return 4 * p; }),
                          Everywhere(mesh, 0.04F));
  for (size_t i = 0; i < lengths.size(); ++i) {
    EXPECT_NEAR(larger[i], 4 * lengths[i], 1e-4F * larger[i]);
  }
}

TEST(LimitGradation, GrowsNoFasterThanAllowed) {
  Random random(7);
  const TriangleMesh mesh = MakeBumpySphere(0.1F);
  std::vector<float> lengths(mesh.vertices.size());
  for (float& length : lengths) {
    length = static_cast<float>(random.Unit());
  }
  const std::vector<float> before = lengths;
  LimitGradation(mesh, 0.3F, &lengths);
  for (const Facet& facet : mesh.facets) {
    for (int k = 0; k < 3; ++k) {
      const uint32_t a = facet[k];
      const uint32_t b = facet[(k + 1) % 3];
      EXPECT_LE(lengths[a],
                lengths[b] +
                    0.3F * (mesh.vertices[a] - mesh.vertices[b]).norm() +
                    1e-5F);
    }
  }
  for (size_t i = 0; i < lengths.size(); ++i) {
    EXPECT_LE(lengths[i], before[i]);
  }
  // As large as that allows: a second time changes nothing.
  std::vector<float> again = lengths;
  LimitGradation(mesh, 0.3F, &again);
  EXPECT_EQ(again, lengths);
}

TEST(MeanEdgeLengths, AreThoseOfARegularMesh) {
  TriangleMesh mesh = MakeTetrahedron();
  const float edge = (mesh.vertices[0] - mesh.vertices[1]).norm();
  for (const float length : MeanEdgeLengths(mesh)) {
    EXPECT_NEAR(length, edge, 0.5F * edge);
  }
}

}  // namespace edge_length_field_test
}  // namespace colmap_ext
