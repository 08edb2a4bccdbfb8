#include "mesh/bvh.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "tests/synthetic/noise.h"

namespace colmap_ext {
namespace {

using synthetic::Hash;
using synthetic::Uniform;

using Eigen::Vector3f;

Vector3f RandomVector(uint64_t i, uint64_t k) {
  return {static_cast<float>(2 * Uniform(Hash(1, i, k, 0)) - 1),
          static_cast<float>(2 * Uniform(Hash(1, i, k, 1)) - 1),
          static_cast<float>(2 * Uniform(Hash(1, i, k, 2)) - 1)};
}

// Small triangles anywhere in a cube.
TriangleMesh Soup(uint32_t num_facets) {
  TriangleMesh mesh;
  for (uint32_t f = 0; f < num_facets; ++f) {
    const Vector3f center = RandomVector(f, 0);
    for (int i = 0; i < 3; ++i) {
      mesh.vertices.push_back(center + 0.2f * RandomVector(f, 1 + i));
    }
    mesh.facets.push_back({3 * f, 3 * f + 1, 3 * f + 2});
  }
  return mesh;
}

// Distance to a facet along a ray, in lengths of its direction; negative where
// it is missed.
double Distance(const TriangleMesh& mesh, const Facet& facet,
                const Vector3f& origin, const Vector3f& direction) {
  const Eigen::Vector3d a = mesh.vertices[facet[0]].cast<double>();
  Eigen::Matrix3d matrix;
  matrix.col(0) = -direction.cast<double>();
  matrix.col(1) = mesh.vertices[facet[1]].cast<double>() - a;
  matrix.col(2) = mesh.vertices[facet[2]].cast<double>() - a;
  const Eigen::Vector3d x = matrix.inverse() * (origin.cast<double>() - a);
  return x[1] >= 0 && x[2] >= 0 && x[1] + x[2] <= 1 ? x[0] : -1;
}

TEST(Bvh, FindsTheNearestFacetAsASearchThroughAllDoes) {
  const TriangleMesh mesh = Soup(500);
  const Bvh bvh(mesh);
  int num_hits = 0;
  for (int packet = 0; packet < 500; ++packet) {
    RayPacket rays;
    rays.origin = 1.5f * RandomVector(packet, 10);
    for (int i = 0; i < 4; ++i) {
      rays.SetDirection(i, RandomVector(packet, 11 + i));
    }
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

TEST(Bvh, SeesNothingInAnEmptyMesh) {
  const Bvh bvh{TriangleMesh()};
  EXPECT_FALSE(bvh.IsOccluded({0, 0, 0}, {1, 0, 0}, 0));
}

TEST(Bvh, OccludesBetweenThePointsOnly) {
  TriangleMesh mesh;
  mesh.vertices = {{0, -1, -1}, {0, 1, -1}, {0, 0, 1}};
  mesh.facets = {{0, 1, 2}};
  const Bvh bvh(mesh);
  EXPECT_TRUE(bvh.IsOccluded({-1, 0, 0}, {1, 0, 0}, 0.1f));
  EXPECT_TRUE(bvh.IsOccluded({1, 0, 0}, {-1, 0, 0}, 0.1f));
  EXPECT_FALSE(bvh.IsOccluded({-1, 0, 0}, {-0.5f, 0, 0}, 0.1f));
  EXPECT_FALSE(bvh.IsOccluded({-1, 0, 0}, {0, 0, 0}, 0.1f));
}

}  // namespace
}  // namespace colmap_ext
