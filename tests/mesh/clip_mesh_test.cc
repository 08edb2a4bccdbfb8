#include "mesh/clip_mesh.h"

#include <algorithm>
#include <span>
#include <utility>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "mesh/manifold_repair.h"
#include "mesh/normals.h"
#include "mesh/topology.h"
#include "tests/mesh/shapes.h"

namespace colmap_ext {
namespace clip_mesh_test {

Region Turned(const Eigen::Vector3d& center, const Eigen::Vector3d& half) {
  return {
      Eigen::Quaterniond(0.9, 0.2, -0.3, 0.1).normalized().toRotationMatrix(),
      center, half};
}

struct Clipped : DerivedMesh {
  bool is_clipped = false;
};

Clipped Clip(const Region& region, const TriangleMesh& mesh) {
  Clipped clipped{{mesh, {}}};
  if (auto from = ClipMesh(region, &clipped.mesh)) {
    clipped.from = std::move(*from);
    clipped.is_clipped = true;
  }
  return clipped;
}

MeshReport AnalyzeSplit(const TriangleMesh& mesh) {
  return Analyze(SplitFans(mesh).mesh);
}

double TurnedDistance(const Region& region, const Eigen::Vector3f& point) {
  return (region.FromCenter(point.cast<double>()).cwiseAbs() -
          region.half_sizes)
      .maxCoeff();
}

TEST(ClipMeshTest, LeavesNothingOutside) {
  for (const TriangleMesh& mesh :
       {MakeBumpySphere(0.1f), MakeRoundTorus(0.08f), MakeFineCube(0.2f)}) {
    const Region region = Turned({0.1, 0.2, 0.3}, {0.6, 0.7, 0.8});
    const Clipped clipped = Clip(region, mesh);
    EXPECT_TRUE(clipped.is_clipped);
    EXPECT_FALSE(clipped.mesh.facets.empty());
    EXPECT_LT(clipped.mesh.facets.size(), mesh.facets.size());
    for (const Eigen::Vector3f& vertex : clipped.mesh.vertices) {
      EXPECT_LT(TurnedDistance(region, vertex), 1e-6);
    }
    EXPECT_TRUE(AnalyzeSplit(clipped.mesh).IsManifold());
  }
}

// The two sides of a plane make up the whole surface, and meet in one curve.
TEST(ClipMeshTest, KeepsAllOfTheSurfaceInside) {
  const TriangleMesh sphere = MakeBumpySphere(0.1f);
  const Eigen::Vector3d half(2, 2, 2);
  const Region upper = Turned({0, 0, 0}, half);
  const Eigen::Vector3d up = upper.region_from_world.row(2);
  const TriangleMesh a =
      Clip({upper.region_from_world, 2.1 * up, half}, sphere).mesh;
  const TriangleMesh b =
      Clip({upper.region_from_world, -1.9 * up, half}, sphere).mesh;
  EXPECT_NEAR(Area(a) + Area(b), Area(sphere), 1e-5);
  EXPECT_EQ(AnalyzeSplit(a).num_border_loops, 1u);
  EXPECT_EQ(AnalyzeSplit(a).num_border_edges, AnalyzeSplit(b).num_border_edges);
}

TEST(ClipMeshTest, NewVerticesLieOnTheEdgesThatAreCut) {
  const TriangleMesh sphere = MakeBumpySphere(0.1f);
  const Clipped clipped =
      Clip(RegionBetween({-2, -2, -2}, {2, 2, 0.123}), sphere);
  ASSERT_EQ(clipped.from.vertices.size(), clipped.mesh.vertices.size());
  for (size_t i = 0; i < clipped.from.vertices.size(); ++i) {
    const auto& [from, to] = clipped.from.vertices[i];
    const Eigen::Vector3f& a = sphere.vertices[from];
    const Eigen::Vector3f& b = sphere.vertices[to];
    const Eigen::Vector3f& p = clipped.mesh.vertices[i];
    EXPECT_NEAR((p - a).norm() + (b - p).norm(), (b - a).norm(), 1e-6);
  }
}

TEST(ClipMeshTest, FacetsLieInThoseThatTheyComeFrom) {
  const TriangleMesh sphere = MakeBumpySphere(0.1f);
  const Region region = Turned({0.1, 0.2, 0.3}, {0.6, 0.7, 0.8});
  Surface cut{sphere, {{}, Rows<uint32_t>(sphere.vertices.size())}};
  const std::vector<uint32_t> sources = CutOff(region, &cut)->facets;
  EXPECT_TRUE(Analyze(cut.mesh).IsManifold());
  EXPECT_EQ(cut.attributes.views.size(), cut.mesh.vertices.size());
  ASSERT_EQ(sources.size(), cut.mesh.facets.size());
  for (size_t i = 0; i < sources.size(); ++i) {
    const Eigen::Vector3f normal = FacetNormal(sphere, sources[i]);
    const Eigen::Vector3f& corner =
        sphere.vertices[sphere.facets[sources[i]][0]];
    for (const Eigen::Vector3f& point :
         CornersOf(cut.mesh, cut.mesh.facets[i])) {
      EXPECT_NEAR(normal.dot(point - corner), 0, 1e-5f);
    }
  }
}

TEST(ClipMeshTest, LeavesAClippedMeshAsItIs) {
  const Region region = Turned({10.1, 0.2, 0.3}, {0.6, 0.7, 0.8});
  const TriangleMesh once =
      Clip(region, Shifted(MakeBumpySphere(0.1f), {10, 0, 0})).mesh;
  const Clipped twice = Clip(region, once);
  EXPECT_FALSE(twice.is_clipped);
  EXPECT_EQ(twice.mesh, once);
}

TEST(ClipMeshTest, AllInsideOrAllOutside) {
  const TriangleMesh sphere = MakeBumpySphere(0.2f);
  const Clipped inside = Clip(Region(), sphere);
  EXPECT_FALSE(inside.is_clipped);
  EXPECT_EQ(inside.mesh.facets, sphere.facets);
  const Clipped outside = Clip(RegionBetween({5, 5, 5}, {6, 6, 6}), sphere);
  EXPECT_TRUE(outside.mesh.facets.empty());
  EXPECT_TRUE(outside.mesh.vertices.empty());
}

TEST(ClipMeshTest, KeepsFacetsInTheBorder) {
  Random random(4);
  const TriangleMesh square = MakeJitteredSquare(5, &random);
  EXPECT_FALSE(Clip(RegionBetween({-3, -3, -3}, {3, 3, 0}), square).is_clipped);
  EXPECT_TRUE(Clip(RegionBetween({-3, -3, 0.1}, {3, 3, 1}), square)
                  .mesh.facets.empty());
}

// Right triangles apart from each other, with a longest side of 5, 10, 15 ...,
// the longest ones first.
TriangleMesh MakeTriangles(uint32_t num_facets) {
  TriangleMesh mesh;
  for (uint32_t i = 0; i < num_facets; ++i) {
    const auto scale = static_cast<float>(num_facets - i);
    const auto z = static_cast<float>(i);
    mesh.vertices.emplace_back(0.0f, 0.0f, z);
    mesh.vertices.emplace_back(3 * scale, 0.0f, z);
    mesh.vertices.emplace_back(0.0f, 4 * scale, z);
    // The longest side is any of the three.
    const Facet facet = {3 * i, 3 * i + 1, 3 * i + 2};
    mesh.facets.push_back(
        {facet[i % 3], facet[(i + 1) % 3], facet[(i + 2) % 3]});
  }
  return mesh;
}

TEST(DropLongFacets, DropsThoseAboveTheFactorTimesThePercentile) {
  const TriangleMesh all = MakeTriangles(11);  // sides 55 ... 5
  struct Case {
    double factor;
    double percentile;
    size_t num_kept;
  };
  for (const auto& [factor, percentile, num_kept] :
       {Case{1, 50, 6},      // 30 and less
        Case{1.49, 50, 8},   // 44.7
        Case{1.5, 50, 9},    // 45, itself kept
        Case{1, 100, 11},    // 55
        Case{1, 0, 1},       // 5
        Case{0.99, 0, 0},    // less than any
        Case{1, 54, 6},      // 5.4 is rounded to 5
        Case{1, 56, 7},      // 5.6 to 6
        Case{25, 95, 11},    // the default
        Case{0, 50, 11}}) {  // off
    SCOPED_TRACE(testing::Message() << factor << " " << percentile);
    TriangleMesh mesh = all;
    EXPECT_EQ(DropLongFacets(factor, percentile, &mesh), 11 - num_kept);
    EXPECT_TRUE(std::ranges::equal(
        mesh.facets, std::span(all.facets).last(num_kept)));  // the shortest
  }
  TriangleMesh nothing;
  EXPECT_EQ(DropLongFacets(1, 50, &nothing), 0);
}

TEST(DropSmallComponents, DropsThoseOfFewerFacets) {
  const TriangleMesh all =
      Union(MakeTetrahedron(),
            Union(MakeTorus(), Union(MakeTetrahedron(), MakeCube())));
  struct Case {
    size_t min_facets;
    DroppedComponents dropped;
  };
  for (const auto& [min_facets, expected] :
       {Case{0, {0, 0}}, Case{1, {0, 0}}, Case{4, {0, 0}}, Case{5, {2, 8}},
        Case{12, {2, 8}}, Case{13, {3, 20}}, Case{70, {3, 20}},
        Case{71, {4, 90}}}) {
    SCOPED_TRACE(min_facets);
    TriangleMesh mesh = all;
    const DroppedComponents dropped =
        DropSmallComponents(min_facets, &mesh.facets);
    EXPECT_EQ(dropped.num_components, expected.num_components);
    EXPECT_EQ(dropped.num_facets, expected.num_facets);
    EXPECT_EQ(mesh.facets.size() + dropped.num_facets, all.facets.size());
  }
  TriangleMesh mesh = all;
  DropSmallComponents(20, &mesh.facets);
  EXPECT_EQ(mesh.facets, std::vector<Facet>(all.facets.begin() + 4,
                                            all.facets.begin() + 74));
}

TEST(DropSmallComponents, VerticesDoNotConnect) {
  TriangleMesh mesh = Union(MakeCube(), MakeTetrahedron());
  MergeVertices(8, 7, &mesh);
  const DroppedComponents dropped = DropSmallComponents(5, &mesh.facets);
  EXPECT_EQ(dropped.num_components, 1u);
  EXPECT_EQ(mesh.facets.size(), 12u);
}

}  // namespace clip_mesh_test
}  // namespace colmap_ext
