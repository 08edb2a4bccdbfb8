#include "refine/refined_confidences.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/mesh/known_meshes.h"
#include "tests/random.h"

namespace colmap_ext {
namespace refined_confidences_test {

// What windows of the same correlation and texture give on each facet.
PhotometricTerms MakeTerms(const TriangleMesh& mesh, double correlation,
                           float texture, float num_pixels = 10) {
  const double saturation = 1 + PhotometricOptions().residual_floor;
  const float weight = texture * num_pixels;
  const auto energy = static_cast<float>(
      weight * saturation * std::log(1 - correlation / saturation));
  return {0, std::vector<FacetTerms>(mesh.facets.size(),
                                     {energy, weight, num_pixels})};
}

const TriangleMesh kMesh = MakeTorus();
const std::vector<float> kHalf(kMesh.vertices.size(), 0.5f);

void ExpectAll(const std::vector<float>& confidences, double value) {
  ASSERT_EQ(confidences.size(), kMesh.vertices.size());
  for (const float confidence : confidences) {
    EXPECT_NEAR(confidence, value, 1e-5);
  }
}

std::vector<float> Confidences(const PhotometricTerms& terms,
                               const std::vector<float>& before) {
  return RefinedConfidences(kMesh, terms, {}, before);
}

TEST(RefinedConfidences, IsTheCorrelationWhereThereIsTexture) {
  for (const double correlation : {0.3, 0.8, 0.99}) {
    ExpectAll(Confidences(MakeTerms(kMesh, correlation, 1), kHalf),
              correlation);
  }
  ExpectAll(Confidences(MakeTerms(kMesh, -0.5, 1), kHalf), 0);
}

TEST(RefinedConfidences, IsTheInputsWhereThereIsNoTexture) {
  ExpectAll(Confidences(MakeTerms(kMesh, 0.9, 0), kHalf), 0.5);
  ExpectAll(Confidences(MakeTerms(kMesh, 0.9, 0.25), kHalf), 0.6);
}

TEST(RefinedConfidences, IsTheInputsWhereNothingIsSeen) {
  ExpectAll(Confidences(MakeTerms(kMesh, 0.9, 1, 0), kHalf), 0.5);
  ExpectAll(Confidences(MakeTerms(kMesh, 0.9, 1, 0), {}), 0);
}

TEST(RefinedConfidences, LiesWithinItsRange) {
  Random random(1);
  PhotometricTerms terms = MakeTerms(kMesh, 0, 1);
  for (size_t i = 0; i < kMesh.facets.size(); ++i) {
    terms.facets[i].energy = static_cast<float>(100 * (random.Unit() - 0.8));
    terms.facets[i].weight = static_cast<float>(10.01 * random.Unit());
  }
  for (const float confidence : Confidences(terms, kHalf)) {
    EXPECT_GE(confidence, 0);
    EXPECT_LE(confidence, 1);
  }
}

}  // namespace refined_confidences_test
}  // namespace colmap_ext
