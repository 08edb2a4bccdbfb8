#include "mesh/vertex_confidences.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/mesh/known_meshes.h"
#include "tests/random.h"

namespace colmap_ext {
namespace vertex_confidences_test {

TEST(VertexConfidences, WeighsFacetsByTheirAngles) {
  // A right angle and half of one at vertex 0.
  const TriangleMesh mesh = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 1, 0}},
                             {{0, 1, 2}, {0, 2, 3}}};
  const std::vector<float> confidences = VertexConfidences(mesh, {0.9f, 0.3f});
  EXPECT_NEAR(confidences[0], (2 * 0.9 + 0.3) / 3, 1e-6);
  EXPECT_NEAR(confidences[1], 0.9, 1e-6);
  EXPECT_NEAR(confidences[3], 0.3, 1e-6);
}

TEST(VertexConfidences, StayWithinThoseOfTheFacets) {
  Random random(1);
  const TriangleMesh mesh = MakeCube();
  std::vector<float> facets;
  for (size_t i = 0; i < mesh.facets.size(); ++i) {
    facets.push_back(static_cast<float>(random.Unit()));
  }
  for (const float confidence : VertexConfidences(mesh, facets)) {
    EXPECT_GE(confidence, *std::min_element(facets.begin(), facets.end()));
    EXPECT_LE(confidence, *std::max_element(facets.begin(), facets.end()));
  }
  const std::vector<float> ones(facets.size(), 1);
  EXPECT_EQ(VertexConfidences(mesh, ones),
            std::vector<float>(mesh.vertices.size(), 1));
}

TEST(VertexConfidences, AVertexWithoutFacetsHasNone) {
  EXPECT_EQ(VertexConfidences({{{0, 0, 0}}, {}}, {}), std::vector<float>{0});
}

TEST(MeanOfCorners, IsThat) {
  EXPECT_EQ(MeanOfCorners({{0, 1, 2}, {2, 2, 1}}, {0, 0.5f, 1}),
            (std::vector<float>{0.5f, 2.5f / 3}));
}

}  // namespace vertex_confidences_test
}  // namespace colmap_ext
