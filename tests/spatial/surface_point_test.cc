#include "spatial/surface_point.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "mesh/normals.h"
#include "spatial/bvh.h"
#include "tests/mesh/shapes.h"

namespace colmap_ext {
namespace surface_point_test {

using Eigen::Vector3f;

Vector3f PointAround(Random* random) {
  return 3 * RandomPoint(random).array() - 1.5F;
}

double DistanceTo(const TriangleMesh& mesh, uint32_t facet,
                  const Vector3f& point) {
  const SurfacePoint nearest = NearestPointOfFacet(mesh, facet, point);
  return (ValueAt(nearest, mesh, mesh.vertices) - point).norm();
}

// No point of the facet, on a grid over it, is nearer.
TEST(NearestPointOfFacet, IsTheNearestOfMany) {
  Random random(1);
  const TriangleMesh mesh = MakeBumpySphere(0.5F);
  for (int i = 0; i < 300; ++i) {
    const auto facet = random.Below(static_cast<uint32_t>(mesh.facets.size()));
    const Vector3f point = PointAround(&random);
    const SurfacePoint nearest = NearestPointOfFacet(mesh, facet, point);
    EXPECT_EQ(nearest.facet, facet);
    EXPECT_NEAR(nearest.weights.sum(), 1, 1e-6);
    EXPECT_GE(nearest.weights.minCoeff(), 0);
    const double distance = DistanceTo(mesh, facet, point);
    constexpr int kSteps = 20;
    for (int a = 0; a <= kSteps; ++a) {
      for (int b = 0; a + b <= kSteps; ++b) {
        const SurfacePoint other{
            facet, Vector3f(static_cast<float>(a), static_cast<float>(b),
                            static_cast<float>(kSteps - a - b)) /
                       kSteps};
        EXPECT_LE(distance,
                  (ValueAt(other, mesh, mesh.vertices) - point).norm() + 1e-6);
      }
    }
  }
}

TEST(NearestPointOfFacet, OfAFacetWithoutAreaIsOnItsSegment) {
  const TriangleMesh mesh = {{{0, 0, 0}, {2, 0, 0}, {1, 0, 0}}, {{0, 1, 2}}};
  EXPECT_NEAR(DistanceTo(mesh, 0, {0.5F, 3, 0}), 3, 1e-6);
  EXPECT_NEAR(DistanceTo(mesh, 0, {3, 0, 0}), 1, 1e-6);
}

// Among the facets that face the way of the normal, as a search through all.
TEST(NearestFacet, IsThatOfASearchThroughAll) {
  Random random(2);
  const TriangleMesh mesh = MakeRoundTorus(0.2F);
  const Bvh bvh(mesh);
  for (int i = 0; i < 300; ++i) {
    const Vector3f point = PointAround(&random);
    const Vector3f normal = PointAround(&random);
    double nearest = std::numeric_limits<double>::infinity();
    for (uint32_t facet = 0; facet < mesh.facets.size(); ++facet) {
      if (AreaVector(mesh, mesh.facets[facet]).dot(normal) > 0) {
        nearest = std::min(nearest, DistanceTo(mesh, facet, point));
      }
    }
    const uint32_t found = bvh.NearestFacet(point, normal, 1e3);
    ASSERT_NE(found, kNone);
    EXPECT_GT(AreaVector(mesh, mesh.facets[found]).dot(normal), 0);
    EXPECT_NEAR(DistanceTo(mesh, found, point), nearest, 1e-5);
    EXPECT_EQ(bvh.NearestFacet(point, normal, 0.9 * nearest), kNone);
    EXPECT_TRUE(bvh.IsNear(point, normal, 1.1 * nearest));
    EXPECT_FALSE(bvh.IsNear(point, normal, 0.9 * nearest));
  }
}

}  // namespace surface_point_test
}  // namespace colmap_ext
