#include "spatial/self_intersections.h"

#include <algorithm>
#include <array>
#include <set>
#include <utility>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "spatial/facet_tree.h"
#include "tests/delaunay/exact.h"
#include "tests/mesh/known_meshes.h"
#include "tests/threads.h"

namespace colmap_ext::self_intersections_test {

using Eigen::Vector3f;
using Pairs = std::vector<FacetPair>;

// Points with integer coordinates.
using Points = std::vector<IntVector>;

Points PointsOf(const TriangleMesh& mesh, const std::vector<uint32_t>& ids) {
  Points points;
  for (const uint32_t vertex : ids) {
    points.push_back(ToIntegers(mesh.vertices[vertex]));
  }
  return points;
}

// The sides of a polygon, or a segment.
Points SidesOf(const Points& points) {
  Points sides;
  for (size_t i = 0; i < points.size(); ++i) {
    sides.push_back(points[(i + 1) % points.size()] - points[i]);
  }
  return sides;
}

bool IsSeparatedAlong(const IntVector& axis, const Points& a, const Points& b) {
  const auto range = [&](const Points& points) {
    std::set<int64_t> heights;
    for (const IntVector& point : points) {
      heights.insert(axis.dot(point));
    }
    return std::pair(*heights.begin(), *heights.rbegin());
  };
  const auto [a_min, a_max] = range(a);
  const auto [b_min, b_max] = range(b);
  return a_max < b_min || b_max < a_min;
}

// Whether a triangle that has an area and a triangle or a segment have no point
// in common: the axes that can tell are normals of the polygons, of their sides
// within the plane, and of two sides.
bool AreSeparated(const Points& a, const Points& b) {
  const Points a_sides = SidesOf(a), b_sides = SidesOf(b);
  const IntVector normal = a_sides[0].cross(a_sides[1]);
  Points axes = {normal, b_sides[0].cross(b_sides[1])};
  for (const IntVector& side : a_sides) {
    axes.push_back(side.cross(normal));
    for (const IntVector& other : b_sides) {
      axes.push_back(side.cross(other));
      axes.push_back(other.cross(normal));
    }
  }
  return std::ranges::any_of(axes, [&](const IntVector& axis) {
    return IsSeparatedAlong(axis, a, b);
  });
}

bool HasArea(const Points& facet) {
  return !(facet[1] - facet[0]).cross(facet[2] - facet[0]).isZero();
}

// \pre integer coordinates
bool MeetExactly(const TriangleMesh& mesh, uint32_t i, uint32_t j) {
  std::vector<uint32_t> first(mesh.facets[i].begin(), mesh.facets[i].end());
  std::vector<uint32_t> second(mesh.facets[j].begin(), mesh.facets[j].end());
  const Points a = PointsOf(mesh, first), b = PointsOf(mesh, second);
  if (i == j) {
    return !HasArea(a);
  }
  if (!HasArea(a) || !HasArea(b)) {
    return false;
  }
  std::ranges::sort(first);
  std::ranges::sort(second);
  std::vector<uint32_t> common, in_first, in_second;
  std::ranges::set_intersection(first, second, std::back_inserter(common));
  std::ranges::set_difference(first, second, std::back_inserter(in_first));
  std::ranges::set_difference(second, first, std::back_inserter(in_second));
  switch (common.size()) {
    case 0:
      return !AreSeparated(a, b);
    case 1:
      return !AreSeparated(a, PointsOf(mesh, in_second)) ||
             !AreSeparated(b, PointsOf(mesh, in_first));
    case 2: {
      const Points edge = PointsOf(mesh, common);
      const IntVector side = edge[1] - edge[0];
      const IntVector n = side.cross(PointsOf(mesh, in_first)[0] - edge[0]);
      const IntVector m = side.cross(PointsOf(mesh, in_second)[0] - edge[0]);
      return n.cross(m).isZero() && n.dot(m) > 0;
    }
    default:
      return true;
  }
}

// By looking at all pairs.
Pairs AllPairs(const TriangleMesh& mesh) {
  Pairs pairs;
  for (uint32_t i = 0; i < mesh.facets.size(); ++i) {
    for (uint32_t j = i; j < mesh.facets.size(); ++j) {
      if (MeetExactly(mesh, i, j)) {
        pairs.push_back({i, j});
      }
    }
  }
  return pairs;
}

// Rounds the vertices to a grid of 1 / size, as integers.
TriangleMesh OnGrid(TriangleMesh mesh, float size) {
  return Moved(std::move(mesh), [size](const Vector3f& point) -> Vector3f {
    return (size * point).array().round();
  });
}

// What the tree must find for a choice of facets.
Pairs WithOneOf(const Pairs& pairs, const std::vector<uint32_t>& facets) {
  Pairs chosen;
  std::ranges::copy_if(
      pairs, std::back_inserter(chosen), [&](const FacetPair& pair) {
        return std::ranges::find_first_of(facets, pair) != facets.end();
      });
  return chosen;
}

std::vector<uint32_t> SomeFacets(const TriangleMesh& mesh, double share,
                                 Random* random) {
  std::vector<uint32_t> facets;
  for (uint32_t i = 0; i < mesh.facets.size(); ++i) {
    if (random->Chance(share)) {
      facets.push_back(i);
    }
  }
  return facets;
}

// Small triangles anywhere in a cube.
TriangleMesh Scattered(uint32_t num_facets, float size, Random* random) {
  Vector3f center;
  return MakeTriangles(num_facets, [&](uint32_t, int k) -> Vector3f {
    center = k == 0 ? RandomPoint(random) : center;
    return center + size * RandomPoint(random);
  });
}

// \return the number of pairs
size_t ExpectAllPairs(const TriangleMesh& mesh) {
  const Pairs pairs = FindSelfIntersections(mesh);
  EXPECT_EQ(pairs, AllPairs(mesh));
  return pairs.size();
}

// On a coarse grid most of what meets touches, lies in one plane, or has no
// area.
TEST(FindSelfIntersections, FindsWhatASearchThroughAllPairsDoes) {
  Random random(1);
  size_t num_pairs = 0;
  for (const uint32_t num_facets : {1u, 2u, 5u, 33u, 300u}) {
    for (const float size : {4.f, 20.f, 1000.f}) {
      num_pairs +=
          ExpectAllPairs(OnGrid(Scattered(num_facets, 0.2f, &random), size));
    }
  }
  EXPECT_GT(num_pairs, 100u);
}

TEST(FindSelfIntersections, OfFacetsThatShareVertices) {
  Random random(2);
  size_t num_pairs = 0;
  for (int trial = 0; trial < 500; ++trial) {
    num_pairs +=
        ExpectAllPairs(OnGrid(RandomSoup(4 + random.Below(8), random.Below(20),
                                         /*allow_duplicates=*/true, &random),
                              std::array{1.f, 3.f, 100.f}[random.Below(3)]));
  }
  EXPECT_GT(num_pairs, 1000u);
}

TEST(FindSelfIntersections, OfChosenFacets) {
  Random random(5);
  for (const float size : {5.f, 1000.f}) {
    const TriangleMesh mesh = OnGrid(Scattered(300, 0.3f, &random), size);
    const Pairs all = FindSelfIntersections(mesh);
    const FacetTree tree(mesh);
    EXPECT_EQ(FindSelfIntersections(mesh, tree), all);
    EXPECT_EQ(FindSelfIntersections(mesh, 7), all);
    for (const double share : {0.0, 0.02, 0.5, 1.0}) {
      const std::vector<uint32_t> facets = SomeFacets(mesh, share, &random);
      EXPECT_EQ(FindSelfIntersections(mesh, tree, facets),
                WithOneOf(all, facets));
    }
  }
}

// A tree serves positions that it was extended to.
TEST(FindSelfIntersections, OfMovedFacetsByOneTree) {
  Random random(6);
  const TriangleMesh mesh = Scattered(300, 0.3f, &random);
  const TriangleMesh moved = {Scattered(300, 0.3f, &random).vertices,
                              mesh.facets};
  TriangleMesh between = mesh;
  for (size_t i = 0; i < mesh.vertices.size(); ++i) {
    between.vertices[i] = 0.5f * (mesh.vertices[i] + moved.vertices[i]);
  }
  FacetTree tree(mesh);
  tree.Enclose(mesh, moved);
  for (const TriangleMesh& now : {mesh, moved, between}) {
    EXPECT_EQ(FindSelfIntersections(now, tree), FindSelfIntersections(now));
  }
  // Some facets only: their vertices are their own.
  FacetTree extended(mesh);
  TriangleMesh partly = mesh;
  const std::vector<uint32_t> facets = SomeFacets(mesh, 0.2, &random);
  for (const uint32_t facet : facets) {
    for (const uint32_t vertex : mesh.facets[facet]) {
      partly.vertices[vertex] = moved.vertices[vertex];
    }
  }
  extended.Extend(partly, facets);
  EXPECT_EQ(FindSelfIntersections(partly, extended),
            FindSelfIntersections(partly));
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

// Two spheres whose surfaces cross along a circle: the pairs form closed
// chains around it, so that every facet on it meets two or more others.
TEST(FindSelfIntersections, OfTwoSpheresLieAlongACircle) {
  const TriangleMesh sphere = MakeBumpySphere(0.05f, 0);
  const TriangleMesh mesh = Union(sphere, Shifted(sphere, {1.0123f, 0, 0}));
  const Pairs pairs = FindSelfIntersections(mesh);
  EXPECT_GT(pairs.size(), 100u);
  EXPECT_TRUE(std::ranges::is_sorted(pairs));
  for (const auto& [a, b] : pairs) {
    EXPECT_LT(a, sphere.facets.size());
    EXPECT_GE(b, sphere.facets.size());
    for (const uint32_t vertex : mesh.facets[a]) {
      EXPECT_NEAR(mesh.vertices[vertex].x(), 0.506f, 0.1f);
    }
  }
}

TEST(FindSelfIntersections, IsTheSameForAnyNumberOfThreads) {
  Random random(4);
  const TriangleMesh mesh = Scattered(20000, 0.05f, &random);
  EXPECT_GT(FindSelfIntersections(mesh).size(), 1000u);
  ExpectSameForAnyThreads([&] { return FindSelfIntersections(mesh); });
}

TEST(FacetTree, FindsAllPairsOfBoxesThatMeetOnce) {
  Random random(1);
  for (const TriangleMesh& mesh :
       {TriangleMesh(), MakeTetrahedron(), MakeDisc(), MakeBumpySphere(0.2f),
        RandomSoup(300, 100, true, &random)}) {
    std::set<std::pair<uint32_t, uint32_t>> expected;
    for (uint32_t a = 0; a < mesh.facets.size(); ++a) {
      for (uint32_t b = a + 1; b < mesh.facets.size(); ++b) {
        if (BoxOf(mesh, a).intersects(BoxOf(mesh, b))) {
          expected.emplace(a, b);
        }
      }
    }
    const FacetTree tree(mesh);
    std::set<std::pair<uint32_t, uint32_t>> found;
    for (size_t leaf = 0; leaf < tree.NumLeaves(); ++leaf) {
      tree.ForEachPair(leaf, [&](uint32_t a, uint32_t b) {
        EXPECT_TRUE(found.insert(std::minmax(a, b)).second);
      });
    }
    EXPECT_EQ(found, expected);
  }
}

}  // namespace colmap_ext::self_intersections_test
