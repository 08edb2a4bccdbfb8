#include "mesh/clip_mesh.h"

#include <cmath>
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

}  // namespace clip_mesh_test
}  // namespace colmap_ext
