#include "spatial/self_intersections.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <Eigen/LU>

#include "tests/mesh/known_meshes.h"
#include "tests/mesh/random_soup.h"
#include "tests/mesh/shapes.h"

namespace colmap_ext {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using Pairs = std::vector<std::array<uint32_t, 2>>;

// Whether the open segment meets the inside of a facet, by the solution of
// p + t (q - p) = a + x (b - a) + y (c - a).
bool Meets(const TriangleMesh& mesh, uint32_t p, uint32_t q,
           const Facet& facet) {
  const Vector3d a = mesh.vertices[facet[0]].cast<double>();
  const Vector3d from = mesh.vertices[p].cast<double>();
  Eigen::Matrix3d matrix;
  matrix.col(0) = from - mesh.vertices[q].cast<double>();
  matrix.col(1) = mesh.vertices[facet[1]].cast<double>() - a;
  matrix.col(2) = mesh.vertices[facet[2]].cast<double>() - a;
  const Vector3d x = matrix.fullPivLu().solve(from - a);
  return x.minCoeff() > 0 && x[0] < 1 && x[1] + x[2] < 1;
}

bool Pierces(const TriangleMesh& mesh, const Facet& first,
             const Facet& second) {
  const std::set<uint32_t> corners(second.begin(), second.end());
  for (int k = 0; k < 3; ++k) {
    const uint32_t p = first[k];
    const uint32_t q = first[(k + 1) % 3];
    if (!corners.contains(p) && !corners.contains(q) &&
        Meets(mesh, p, q, second)) {
      return true;
    }
  }
  return false;
}

// By looking at all pairs.
Pairs AllPairs(const TriangleMesh& mesh) {
  Pairs pairs;
  for (uint32_t i = 0; i < mesh.facets.size(); ++i) {
    for (uint32_t j = i + 1; j < mesh.facets.size(); ++j) {
      const std::set<uint32_t> first(mesh.facets[i].begin(),
                                     mesh.facets[i].end());
      std::set<uint32_t> both = first;
      both.insert(mesh.facets[j].begin(), mesh.facets[j].end());
      if (both.size() >= 5 && (Pierces(mesh, mesh.facets[i], mesh.facets[j]) ||
                               Pierces(mesh, mesh.facets[j], mesh.facets[i]))) {
        pairs.push_back({i, j});
      }
    }
  }
  return pairs;
}

// Small triangles anywhere in a cube.
TriangleMesh Scattered(uint32_t num_facets, float size, Random* random) {
  const auto vector = [&] {
    return Vector3f(static_cast<float>(random->Unit()),
                    static_cast<float>(random->Unit()),
                    static_cast<float>(random->Unit()));
  };
  TriangleMesh mesh;
  for (uint32_t f = 0; f < num_facets; ++f) {
    const Vector3f center = vector();
    for (int k = 0; k < 3; ++k) {
      mesh.vertices.push_back(center + size * vector());
    }
    mesh.facets.push_back({3 * f, 3 * f + 1, 3 * f + 2});
  }
  return mesh;
}

TEST(FindSelfIntersections, FindsWhatASearchThroughAllPairsDoes) {
  Random random(1);
  size_t num_pairs = 0;
  for (const uint32_t num_facets : {1u, 2u, 5u, 33u, 700u}) {
    const TriangleMesh mesh = Scattered(num_facets, 0.2f, &random);
    const Pairs pairs = FindSelfIntersections(mesh);
    EXPECT_EQ(pairs, AllPairs(mesh));
    num_pairs += pairs.size();
  }
  EXPECT_GT(num_pairs, 100u);
}

TEST(FindSelfIntersections, OfFacetsThatShareVertices) {
  Random random(2);
  size_t num_pairs = 0;
  for (int trial = 0; trial < 500; ++trial) {
    const TriangleMesh mesh = RandomSoup(4 + random.Below(8), random.Below(20),
                                         /*allow_duplicates=*/true, &random);
    const Pairs pairs = FindSelfIntersections(mesh);
    EXPECT_EQ(pairs, AllPairs(mesh));
    num_pairs += pairs.size();
  }
  EXPECT_GT(num_pairs, 1000u);
}

TEST(FindSelfIntersections, FindsNoneWhereThereIsNone) {
  Random random(3);
  for (const TriangleMesh& mesh :
       {TriangleMesh(), MakeTetrahedron(), MakeCube(), MakeDisc(),
        MakeJitteredSquare(30, &random), MakeBumpySphere(0.05f),
        MakeBumpyCap(0.05f), MakeRoundTorus(0.1f), MakeFineCube(0.1f)}) {
    EXPECT_TRUE(FindSelfIntersections(mesh).empty());
  }
}

// Edges of one meet edges and vertices of the other exactly.
TEST(FindSelfIntersections, FindsFacetsThatCrossAtTheirEdges) {
  const TriangleMesh mesh = {
      {{-1, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}, {0, -1, 0}},
      {{0, 1, 2}, {3, 4, 5}}};
  EXPECT_EQ(FindSelfIntersections(mesh), (Pairs{{0, 1}}));
}

TEST(FindSelfIntersections, DoesNotCountWhatTouches) {
  // The second has a corner on the first, the third lies in the first's plane.
  const TriangleMesh mesh = {{{0, 0, 0},
                              {4, 0, 0},
                              {0, 4, 0},
                              {1, 1, 0},
                              {1, 1, 2},
                              {2, 1, 2},
                              {2, 0.5f, 0},
                              {3, 1, 0},
                              {2, 2, 0}},
                             {{0, 1, 2}, {3, 4, 5}, {6, 7, 8}}};
  EXPECT_TRUE(FindSelfIntersections(mesh).empty());
}

// Two spheres whose surfaces cross along a circle: the pairs form closed
// chains around it, so that every facet on it meets two or more others.
TEST(FindSelfIntersections, OfTwoSpheresLieAlongACircle) {
  const TriangleMesh sphere = MakeBumpySphere(0.05f, 0);
  TriangleMesh moved = sphere;
  for (Vector3f& vertex : moved.vertices) {
    vertex.x() += 1.0123f;
  }
  const TriangleMesh mesh = Union(sphere, moved);
  const Pairs pairs = FindSelfIntersections(mesh);
  EXPECT_GT(pairs.size(), 100u);
  EXPECT_TRUE(std::is_sorted(pairs.begin(), pairs.end()));
  for (const auto& [a, b] : pairs) {
    EXPECT_LT(a, sphere.facets.size());
    EXPECT_GE(b, sphere.facets.size());
    for (const uint32_t vertex : mesh.facets[a]) {
      EXPECT_NEAR(mesh.vertices[vertex].x(), 0.506f, 0.1f);
    }
  }
}

TEST(FindSelfIntersections, FindsAVertexPulledThroughTheOtherSide) {
  TriangleMesh mesh = MakeBumpySphere(0.1f, 0);
  mesh.vertices[0] *= -2;
  // The spike's facets run through one place of the other side at least, and
  // meet facets there that share no vertex with them.
  const Pairs pairs = FindSelfIntersections(mesh);
  EXPECT_GT(pairs.size(), 3u);
  for (const auto& [a, b] : pairs) {
    const auto has_spike = [&](uint32_t facet) {
      return std::count(mesh.facets[facet].begin(), mesh.facets[facet].end(),
                        0u) == 1;
    };
    EXPECT_NE(has_spike(a), has_spike(b));
  }
}

TEST(FindSelfIntersections, IsTheSameForAnyNumberOfThreads) {
  Random random(4);
  const TriangleMesh mesh = Scattered(20000, 0.05f, &random);
  const Pairs expected = FindSelfIntersections(mesh);
  EXPECT_GT(expected.size(), 1000u);
  for (const size_t num_threads : {1, 2, 7}) {
    const tbb::global_control control(
        tbb::global_control::max_allowed_parallelism, num_threads);
    EXPECT_EQ(FindSelfIntersections(mesh), expected);
  }
}

}  // namespace
}  // namespace colmap_ext
