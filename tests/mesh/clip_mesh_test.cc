#include "mesh/clip_mesh.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "mesh/mesh_in_image.h"
#include "mesh/normals.h"
#include "mesh/split_fans.h"
#include "mesh/topology.h"
#include "tests/look_at.h"
#include "tests/mesh/known_meshes.h"

namespace colmap_ext::clip_mesh_test {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector3f;

Region Turned(const Vector3d& center, const Vector3d& half) {
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

double TurnedDistance(const Region& region, const Vector3f& point) {
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
    for (const Vector3f& vertex : clipped.mesh.vertices) {
      EXPECT_LT(TurnedDistance(region, vertex), 1e-6);
    }
    EXPECT_TRUE(AnalyzeSplit(clipped.mesh).IsManifold());
  }
}

// The two sides of a plane make up the whole surface, and meet in one curve.
TEST(ClipMeshTest, KeepsAllOfTheSurfaceInside) {
  const TriangleMesh sphere = MakeBumpySphere(0.1f);
  const Vector3d half(2, 2, 2);
  const Region upper = Turned({0, 0, 0}, half);
  const Vector3d up = upper.region_from_world.row(2);
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
    const Vector3f& a = sphere.vertices[from];
    const Vector3f& b = sphere.vertices[to];
    const Vector3f& p = clipped.mesh.vertices[i];
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
    const Vector3f normal = FacetNormal(sphere, sources[i]);
    const Vector3f& corner = sphere.vertices[sphere.facets[sources[i]][0]];
    for (const Vector3f& point : CornersOf(cut.mesh, cut.mesh.facets[i])) {
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

TEST(ClipMeshTest, AllInsideOrAllOutsideOrInTheBorder) {
  const TriangleMesh sphere = MakeBumpySphere(0.2f);
  const Clipped inside = Clip(Region(), sphere);
  EXPECT_FALSE(inside.is_clipped);
  EXPECT_EQ(inside.mesh.facets, sphere.facets);
  const Clipped outside = Clip(RegionBetween({5, 5, 5}, {6, 6, 6}), sphere);
  EXPECT_TRUE(outside.mesh.facets.empty());
  EXPECT_TRUE(outside.mesh.vertices.empty());
  Random random(4);
  const TriangleMesh square = MakeJitteredSquare(5, &random);
  EXPECT_FALSE(Clip(RegionBetween({-3, -3, -3}, {3, 3, 0}), square).is_clipped);
  EXPECT_TRUE(Clip(RegionBetween({-3, -3, 0.1}, {3, 3, 1}), square)
                  .mesh.facets.empty());
}

// Right triangles with a longest side of 5, 10, 15 ..., which is any of the
// three; the longest ones first.
TriangleMesh RightTriangles(uint32_t num_facets) {
  return MakeTriangles(num_facets, [&](uint32_t i, int k) -> Vector3f {
    const auto scale = static_cast<float>(num_facets - i);
    const uint32_t corner = (i + k) % 3;
    return {corner == 1 ? 3 * scale : 0, corner == 2 ? 4 * scale : 0,
            static_cast<float>(i)};
  });
}

TEST(DropLongFacets, DropsThoseAboveTheFactorTimesThePercentile) {
  const TriangleMesh all = RightTriangles(11);  // sides 55 ... 5
  for (const auto& [factor, percentile, num_kept] :
       {std::tuple(1.0, 50, 6u),      // 30 and less
        std::tuple(1.49, 50, 8u),     // 44.7
        std::tuple(1.5, 50, 9u),      // 45, itself kept
        std::tuple(1.0, 100, 11u),    // 55
        std::tuple(1.0, 0, 1u),       // 5
        std::tuple(0.99, 0, 0u),      // less than any
        std::tuple(1.0, 54, 6u),      // 5.4 is rounded to 5
        std::tuple(1.0, 56, 7u),      // 5.6 to 6
        std::tuple(25.0, 95, 11u),    // the default
        std::tuple(0.0, 50, 11u)}) {  // off
    SCOPED_TRACE(testing::Message() << factor << " " << percentile);
    TriangleMesh mesh = all;
    EXPECT_EQ(DropLongFacets(factor, percentile, &mesh), 11 - num_kept);
    EXPECT_TRUE(std::ranges::equal(
        mesh.facets, std::span(all.facets).last(num_kept)));  // the shortest
  }
  TriangleMesh nothing;
  EXPECT_EQ(DropLongFacets(1, 50, &nothing), 0);
}

TEST(DropLongFacets, KeepsThoseThatContinueTheSurface) {
  const auto flat = [](float, float) { return 0.0f; };
  // Between the columns 15 and 16 facets are ten times as long: in a sheet,
  // and as the lid between two walls.
  TriangleMesh sheet = Moved(MakeHeightField(30, flat), [](const auto& p) {
    return Vector3f(p.x() + (p.x() > 15 ? 9 : 0), p.y(), 0);
  });
  const TriangleMesh all = sheet;
  EXPECT_EQ(DropLongFacets(2, 50, &sheet), 0);
  EXPECT_EQ(sheet, all);
  TriangleMesh walls = Moved(MakeHeightField(30, flat), [](const auto& p) {
    return p.x() > 15 ? Vector3f(25, p.y(), 16 - p.x())
                      : Vector3f(15, p.y(), p.x() - 15);
  });
  EXPECT_EQ(DropLongFacets(2, 50, &walls), 60);
  // The end of a sheet, with less than twice as much border as rim, and more.
  for (const float length : {10.0f, 40.0f}) {
    TriangleMesh end = Moved(MakeHeightField(30, flat), [=](const auto& p) {
      return Vector3f(p.x() > 29 ? 29 + length : p.x(), p.y(), 0);
    });
    EXPECT_EQ(DropLongFacets(2, 50, &end), length == 10 ? 0 : 60);
  }
}

TEST(DropSmallComponents, DropsThoseOfFewerFacetsThatEdgesConnect) {
  const TriangleMesh all =
      Union(MakeTetrahedron(),
            Union(MakeTorus(), Union(MakeTetrahedron(), MakeCube())));
  for (const auto& [min_facets, num_components, num_facets] :
       {std::tuple(0, 0u, 0u),
        {1, 0u, 0u},
        {4, 0u, 0u},
        {5, 2u, 8u},
        {12, 2u, 8u},
        {13, 3u, 20u},
        {70, 3u, 20u},
        {71, 4u, 90u}}) {
    SCOPED_TRACE(min_facets);
    TriangleMesh mesh = all;
    EXPECT_EQ(DropSmallComponents(min_facets, &mesh.facets), num_components);
    EXPECT_EQ(mesh.facets.size() + num_facets, all.facets.size());
  }
  TriangleMesh mesh = all;
  DropSmallComponents(20, &mesh.facets);
  EXPECT_EQ(mesh.facets, std::vector<Facet>(all.facets.begin() + 4,
                                            all.facets.begin() + 74));
  TriangleMesh touching = Union(MakeCube(), MakeTetrahedron());
  MergeVertices(8, 7, &touching);
  EXPECT_EQ(DropSmallComponents(5, &touching.facets), 1u);
  EXPECT_EQ(touching.facets.size(), 12u);
}

// At the origin.
View MakeView() { return LookAt({0, 0, 0}, {1, 2, 3}, 64, 48, 50); }

// All around the camera.
TriangleMesh RandomTriangle(Random* random) {
  return MakeTriangles(1, [&](uint32_t, int) -> Vector3f {
    return 4 * RandomPoint(random).array() - 2;
  });
}

// px^2, of the image
double AreaByRays(const View& view, const TriangleMesh& mesh) {
  constexpr int kRays = 4;  // a pixel, along u and v
  double area = 0;
  for (int i = 0; i < kRays * view.width; ++i) {
    for (int j = 0; j < kRays * view.height; ++j) {
      const Vector2d pixel = Vector2d(i + 0.5, j + 0.5) / kRays;
      area += InverseDepthAt(view, mesh, 0, pixel) > 0 ? 1 : 0;
    }
  }
  return area / (kRays * kRays);
}

double Cross(const Vector2d& a, const Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

TEST(ClipToImage, LeavesWhatRaysOfTheImageMeet) {
  Random random(1);
  const View view = MakeView();
  int num_parts = 0;
  int num_behind = 0;
  for (int trial = 0; trial < 100; ++trial) {
    const TriangleMesh mesh = RandomTriangle(&random);
    const std::vector<Vector3d> part =
        ClipToImage(view, mesh, mesh.facets[0], ImageBox(view));
    std::vector<Vector2d> pixels;
    for (const Vector3d& corner : part) {
      EXPECT_GT(corner.z(), 0);
      pixels.push_back(view.ImageFromCam(corner));
      EXPECT_GT(pixels.back().minCoeff(), -1e-6);
      EXPECT_LT(pixels.back().x(), view.width + 1e-6);
      EXPECT_LT(pixels.back().y(), view.height + 1e-6);
    }
    double area = 0;
    for (size_t k = 0; k < pixels.size(); ++k) {
      area += Cross(pixels[k], pixels[(k + 1) % pixels.size()]) / 2;
    }
    const double area_by_rays = AreaByRays(view, mesh);
    EXPECT_NEAR(std::abs(area), area_by_rays, 25) << trial;
    num_parts += part.empty() ? 0 : 1;
    // The area of a facet that reaches behind is that of what the image shows.
    const auto num_before =
        std::ranges::count_if(mesh.vertices, [&](const Vector3f& vertex) {
          return view.CamFromWorld(vertex.cast<double>()).z() > 0;
        });
    if (num_before == 1 || num_before == 2) {
      EXPECT_NEAR(AreaInImage(mesh, mesh.facets[0], view), area_by_rays, 25);
      num_behind += area_by_rays > 100 ? 1 : 0;
    }
  }
  EXPECT_GT(num_parts, 15);
  EXPECT_GT(num_behind, 5);
}

// Also of one that is seen from its edge, or through the camera's centre.
TEST(ClipToImage, LeavesNothingOfWhatLiesBehindOrAtTheCamera) {
  const View view{"", 64, 48, 1, 1, 32, 24};
  for (const std::vector<Vector3f>& corners :
       {std::vector<Vector3f>{{-1, -1, -1}, {1, -1, -1}, {0, 1, -2}},
        {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}},
        {{0, 0, 0}, {0, 1, 0}, {0, 0, 1}}}) {
    const TriangleMesh mesh{corners, {{0, 1, 2}}};
    EXPECT_TRUE(
        ClipToImage(view, mesh, mesh.facets[0], ImageBox(view)).empty());
    EXPECT_EQ(AreaInImage(mesh, mesh.facets[0], view), 0);
  }
}

TEST(Footprints, AreThoseOfTheMedianViews) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 4}, {0, 0, 8}, {1, 0, 6}};
  const View view{"", 0, 0, 2, 2};  // at the origin, along z
  View near = view;
  near.cam_from_world_translation = {0, 0, -2};
  View behind = view;  // the first vertex lies behind it
  behind.cam_from_world_translation = {0, 0, -5};
  const Rows<uint32_t> vertex_views({0, 3, 6, 6}, {0, 1, 2, 0, 1, 2});
  EXPECT_EQ(Footprints(mesh, vertex_views, {view, near, behind}),
            (std::vector<float>{1.5, 3, 2}));
  EXPECT_EQ(MedianFootprint(mesh, vertex_views, {view, near, behind}), 2);
  EXPECT_EQ(Footprints(mesh, Rows<uint32_t>(3), {view}),
            (std::vector<float>{0, 0, 0}));
}

}  // namespace colmap_ext::clip_mesh_test
