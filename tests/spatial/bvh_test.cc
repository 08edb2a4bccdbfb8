#include "spatial/bvh.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>
#include <Eigen/QR>

#include "mesh/normals.h"
#include "tests/mesh/known_meshes.h"

namespace colmap_ext::bvh_test {

using Eigen::Vector3d;
using Eigen::Vector3f;
using synthetic::Hash;
using synthetic::Uniform;

Vector3f RandomVector(uint64_t i, uint64_t k) {
  return {static_cast<float>(2 * Uniform(Hash(1, i, k, 0)) - 1),
          static_cast<float>(2 * Uniform(Hash(1, i, k, 1)) - 1),
          static_cast<float>(2 * Uniform(Hash(1, i, k, 2)) - 1)};
}

// Small triangles anywhere in a cube.
TriangleMesh Soup(uint32_t num_facets) {
  return MakeTriangles(num_facets, [](uint32_t f, int k) -> Vector3f {
    return RandomVector(f, 0) + 0.2f * RandomVector(f, 1 + k);
  });
}

// Distance to a facet along a ray, in lengths of its direction; negative where
// it is missed.
double Distance(const TriangleMesh& mesh, const Facet& facet,
                const Vector3f& origin, const Vector3f& direction) {
  const auto [a, b, c] = CornersOf<double>(mesh, facet);
  Eigen::Matrix3d matrix;
  matrix << -direction.cast<double>(), b - a, c - a;
  const Vector3d x = matrix.inverse() * (origin.cast<double>() - a);
  return x[1] >= 0 && x[2] >= 0 && x[1] + x[2] <= 1 ? x[0] : -1;
}

// \param direction  of ray 0 ... 3
template <typename Direction>
RayPacket Rays(const Vector3f& origin, const Direction& direction) {
  RayPacket rays;
  rays.origin = origin;
  for (int i = 0; i < 4; ++i) {
    rays.SetDirection(i, direction(i));
  }
  return rays;
}

TEST(Bvh, FindsTheNearestFacetAsASearchThroughAllDoes) {
  const TriangleMesh mesh = Soup(500);
  const Bvh bvh(mesh);
  int num_hits = 0;
  for (int packet = 0; packet < 500; ++packet) {
    const RayPacket rays = Rays(1.5f * RandomVector(packet, 10), [&](int i) {
      return RandomVector(packet, 11 + i);
    });
    const HitPacket hits = bvh.Intersect(rays);
    for (int i = 0; i < 4; ++i) {
      double nearest = 1e30;
      for (const Facet& facet : mesh.facets) {
        const double t = Distance(mesh, facet, rays.origin,
                                  Vector3f(rays.x[i], rays.y[i], rays.z[i]));
        nearest = t > 0 ? std::min(nearest, t) : nearest;
      }
      // Edges are a little wider than they are.
      if (hits.facet[i] < 0) {
        EXPECT_EQ(nearest, 1e30);
        continue;
      }
      ++num_hits;
      EXPECT_NEAR(hits.distance[i], nearest, 1e-3 * nearest);
    }
  }
  EXPECT_GT(num_hits, 300);
}

// Rays along axes and diagonals of a lattice whose points are the corners of
// facets lie in the planes of boxes. A search through all by doubles finds each
// hit; facets are a little wider than they are, so others may come before.
TEST(Bvh, MissesNoFacetWhoseBoxHasAPlaneInWhichTheRayLies) {
  const auto lattice = [](uint64_t i, uint64_t k) -> Vector3f {
    return (3 * RandomVector(i, k)).array().round();
  };
  const TriangleMesh mesh =
      MakeTriangles(60, [&](uint32_t f, int k) { return lattice(f, 30 + k); });
  int num_hits = 0;
  for (int packet = 0; packet < 2000; ++packet) {
    const RayPacket rays = Rays(lattice(packet, 40), [&](int i) {
      // Some of the zeros are negative.
      const Vector3f direction =
          (1.2f * RandomVector(packet, 41 + i)).array().round();
      return direction.isZero() ? Vector3f(0, -0.f, 1) : direction;
    });
    const HitPacket hits =
        Bvh({mesh.vertices, {mesh.facets[packet % 60]}}).Intersect(rays);
    const HitPacket hits_of_all = Bvh(mesh).Intersect(rays);
    for (int i = 0; i < 4; ++i) {
      const Vector3f direction(rays.x[i], rays.y[i], rays.z[i]);
      const double t =
          Distance(mesh, mesh.facets[packet % 60], rays.origin, direction);
      if (t > 1e-6) {  // else the ray starts on it
        ++num_hits;
        EXPECT_EQ(hits.facet[i], 0) << packet;
        EXPECT_NEAR(hits.distance[i], t, 1e-5 * t);
        EXPECT_LE(hits_of_all.distance[i], t * (1 + 1e-5));
      }
    }
  }
  EXPECT_GT(num_hits, 300);
}

TEST(Bvh, SeesNothingInAnEmptyMesh) {
  const Bvh bvh{TriangleMesh()};
  EXPECT_EQ(bvh.Distance({0, 0, 0}, 0.1), 0.1);
  RayPacket rays = Rays({0, 0, 0}, [](int i) { return RandomVector(0, i); });
  rays.max_distance = 7;
  const HitPacket hits = bvh.Intersect(rays);
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(hits.facet[i], -1);
    EXPECT_EQ(hits.distance[i], 7);
  }
}

TEST(Bvh, SeesNothingBeyondTheDistances) {
  const Bvh bvh({{{0, -1, -1}, {0, 1, -1}, {0, 0, 1}}, {{0, 1, 2}}});
  const auto is_hit = [&](float x, float direction, float min, float max) {
    RayPacket rays =
        Rays({x, 0, 0}, [&](int) { return Vector3f(direction, 0, 0); });
    rays.min_distance = min;
    rays.max_distance = max;
    return bvh.Intersect(rays).facet[0] == 0;
  };
  EXPECT_TRUE(is_hit(-1, 1, 0.1f, 1.9f));
  EXPECT_TRUE(is_hit(1, -1, 0.1f, 1.9f));
  EXPECT_FALSE(is_hit(-1, 1, 0.1f, 0.4f));
  EXPECT_FALSE(is_hit(-1, 1, 1.1f, 1.9f));
  EXPECT_FALSE(is_hit(-1, -1, 0.1f, 1.9f));
}

Vector3d NearestOnSegment(const Vector3d& p, const Vector3d& a,
                          const Vector3d& b) {
  const Vector3d d = b - a;
  const double t = d.norm() > 0 ? d.dot(p - a) / d.squaredNorm() : 0;
  return a + std::clamp(t, 0.0, 1.0) * d;
}

// Distance from a point to a facet, by the least squares of the plane's two
// coordinates where their solution lies in the facet.
double Distance(const Vector3d& p, const TriangleMesh& mesh,
                const Facet& facet) {
  const auto [a, b, c] = CornersOf<double>(mesh, facet);
  double nearest = std::min({(p - NearestOnSegment(p, a, b)).norm(),
                             (p - NearestOnSegment(p, b, c)).norm(),
                             (p - NearestOnSegment(p, c, a)).norm()});
  Eigen::Matrix<double, 3, 2> sides;
  sides << b - a, c - a;
  const auto qr = sides.colPivHouseholderQr();
  if (qr.rank() == 2) {
    const Eigen::Vector2d x = qr.solve(p - a);
    if (x.minCoeff() >= 0 && x.sum() <= 1) {
      nearest = std::min(nearest, (p - a - sides * x).norm());
    }
  }
  return nearest;
}

double Distance(const Vector3f& point, const TriangleMesh& mesh) {
  double nearest = 1e30;
  for (const Facet& facet : mesh.facets) {
    nearest = std::min(nearest, Distance(point.cast<double>(), mesh, facet));
  }
  return nearest;
}

// Some facets without area: points, segments, slivers.
TriangleMesh SoupWithDegenerateFacets(uint32_t num_facets) {
  TriangleMesh mesh = Soup(num_facets);
  for (uint32_t f = 0; f < num_facets; f += 4) {
    Facet& facet = mesh.facets[f];
    switch (f / 4 % 4) {
      case 0:
        facet = {facet[0], facet[0], facet[0]};
        break;
      case 1:
        facet[2] = facet[0];
        break;
      case 2:  // on a line
        mesh.vertices[facet[2]] =
            2 * mesh.vertices[facet[1]] - mesh.vertices[facet[0]];
        break;
      default:  // nearly so
        mesh.vertices[facet[2]] =
            mesh.vertices[facet[1]] + Vector3f::Constant(1e-6f);
    }
  }
  return mesh;
}

TEST(BvhDistance, IsThatOfASearchThroughAll) {
  for (const uint32_t num_facets : {1u, 2u, 3u, 17u, 300u}) {
    const TriangleMesh mesh = SoupWithDegenerateFacets(num_facets);
    const Bvh bvh(mesh);
    for (int i = 0; i < 500; ++i) {
      const Vector3f point = 1.3f * RandomVector(i, 20);
      const double distance = Distance(point, mesh);
      EXPECT_NEAR(bvh.Distance(point, 10), distance, 1e-6);
      EXPECT_NEAR(bvh.Distance(point, 0.1), std::min(distance, 0.1), 1e-6);
    }
    for (const Vector3f& vertex : mesh.vertices) {
      EXPECT_LE(bvh.Distance(vertex, 10), Distance(vertex, mesh) + 1e-6);
    }
  }
}

TEST(BvhDistance, ToAPlaneIsExactAndNoMoreThanTheMaximum) {
  const Bvh bvh(MakeSheet(9, 9));
  for (int i = 0; i < 200; ++i) {
    Vector3f point = Vector3f::Constant(4.5f) + 4.5f * RandomVector(i, 21);
    for (const float distance : {0.0f, 0.1f, -3e-5f}) {
      point.z() = distance;
      EXPECT_EQ(bvh.Distance(point, 1), std::abs(double{distance}));
    }
  }
  const TriangleMesh point = {{{1, 0, 0}}, {{0, 0, 0}}};
  EXPECT_EQ(Bvh(point).Distance({0, 0, 0}, 0.1), 0.1);
  EXPECT_EQ(Bvh(point).Distance({0, 0, 0}, 2), 1);
}

Vector3f PointAround(Random* random) {
  return 3 * RandomPoint(random).array() - 1.5F;
}

double DistanceTo(const TriangleMesh& mesh, uint32_t facet,
                  const Vector3f& point) {
  const SurfacePoint nearest = NearestPointOfFacet(mesh, facet, point);
  return (ValueAt(nearest, mesh, mesh.vertices) - point).norm();
}

// No point of the facet, on a grid over it, is nearer.
TEST(NearestPointOfFacet, IsTheNearestOfManyAndOfASegmentOnIt) {
  Random random(1);
  const TriangleMesh mesh = MakeBumpySphere(0.5F);
  for (int i = 0; i < 300; ++i) {
    const uint32_t facet = random.Below(mesh.facets.size());
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
  const TriangleMesh line = {{{0, 0, 0}, {2, 0, 0}, {1, 0, 0}}, {{0, 1, 2}}};
  EXPECT_NEAR(DistanceTo(line, 0, {0.5F, 3, 0}), 3, 1e-6);
  EXPECT_NEAR(DistanceTo(line, 0, {3, 0, 0}), 1, 1e-6);
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

}  // namespace colmap_ext::bvh_test
