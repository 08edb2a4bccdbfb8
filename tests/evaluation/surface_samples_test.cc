#include "evaluation/surface_samples.h"

#include <algorithm>
#include <stdexcept>

#include <gtest/gtest.h>

#include "spatial/bvh.h"
#include "tests/random.h"

namespace colmap_ext {
namespace surface_samples_test {

using Eigen::Vector3f;

Vector3f RandomPoint(Random* random) {
  return {static_cast<float>(random->Unit()),
          static_cast<float>(random->Unit()),
          static_cast<float>(random->Unit())};
}

TEST(SampleSurface, IsNowhereFartherThanTheSpacing) {
  constexpr double kSpacing = 0.05;
  Random random(2);
  for (int i = 0; i < 50; ++i) {
    TriangleMesh mesh;
    for (int k = 0; k < 3; ++k) {
      mesh.vertices.push_back(RandomPoint(&random));
    }
    if (i % 5 == 0) {  // a sliver
      mesh.vertices[2] = 0.3f * mesh.vertices[0] + 0.7f * mesh.vertices[1] +
                         1e-4f * mesh.vertices[2];
    }
    mesh.facets = {{0, 1, 2}};
    const Bvh bvh(mesh);
    const std::vector<Vector3f> samples = SampleSurface(mesh, kSpacing);
    for (const Vector3f& sample : samples) {
      EXPECT_LT(bvh.Distance(sample, 1), 1e-6);
    }
    for (int k = 0; k < 100; ++k) {
      float u = static_cast<float>(random.Unit());
      float v = static_cast<float>(random.Unit());
      if (u + v > 1) {
        u = 1 - u;
        v = 1 - v;
      }
      const Vector3f point = (1 - u - v) * mesh.vertices[0] +
                             u * mesh.vertices[1] + v * mesh.vertices[2];
      float nearest = 1;
      for (const Vector3f& sample : samples) {
        nearest = std::min(nearest, (sample - point).norm());
      }
      EXPECT_LT(nearest, kSpacing + 1e-6);
    }
  }
}

TEST(SampleSurface, OfADegenerateFacetIsOnIt) {
  const TriangleMesh mesh = {{{1, 2, 3}, {2, 2, 3}}, {{0, 0, 0}, {0, 1, 0}}};
  const std::vector<Vector3f> samples = SampleSurface(mesh, 0.5);
  ASSERT_GE(samples.size(), 2);
  EXPECT_EQ(samples[0], Vector3f(1, 2, 3));
  for (const Vector3f& sample : samples) {
    EXPECT_TRUE(sample.allFinite());
  }
}

TEST(SampleSurface, RefusesASpacingThatIsTooSmall) {
  const TriangleMesh mesh = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  EXPECT_THROW(SampleSurface(mesh, 1e-8), std::invalid_argument);
}

}  // namespace surface_samples_test
}  // namespace colmap_ext
