#include "raster/facet_clusters.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "base/indices.h"
#include "raster/facet_id_buffer.h"
#include "tests/mesh/known_meshes.h"
#include "tests/raster/visible_facets.h"

namespace colmap_ext::facet_clusters_test {

using Eigen::Vector3d;
using Eigen::Vector3f;

// Bodies all around the origin, beside each other in the mesh too.
TriangleMesh MakeBodies(int count, Random* random) {
  TriangleMesh mesh;
  for (int i = 0; i < count; ++i) {
    const Vector3f offset = 20 * RandomPoint(random).array() - 10;
    mesh = Union(mesh, Shifted(MakeBumpySphere(0.3f, 0), offset));
  }
  return mesh;
}

size_t NumFacets(const std::vector<FacetRange>& ranges) {
  size_t count = 0;
  ForEachFacet(ranges, [&](uint32_t) { ++count; });
  return count;
}

constexpr double kMinCosine = 0.1;

// Compares a drawing with that of the same facets in a random order, where no
// run of them can be left out.
DrawnFacets ExpectAllIsDrawn(const View& view, const TriangleMesh& mesh,
                             Random* random) {
  std::vector<uint32_t> order = Iota(mesh.facets.size());
  random->Shuffle(&order);
  TriangleMesh shuffled{mesh.vertices, {}};
  for (const uint32_t facet : order) {
    shuffled.facets.push_back(mesh.facets[facet]);
  }
  const DrawnFacets all = DrawFacets(view, shuffled, kMinCosine);
  DrawnFacets drawn = DrawFacets(view, mesh, kMinCosine);
  EXPECT_EQ(drawn.inverse_depths, all.inverse_depths);
  for (size_t i = 0; i < drawn.facets.size(); ++i) {
    EXPECT_EQ(drawn.facets[i],
              all.facets[i] == kNone ? kNone : order[all.facets[i]]);
  }
  std::vector<uint32_t> clipped;
  for (const uint32_t facet : all.clipped) {
    clipped.push_back(order[facet]);
  }
  std::ranges::sort(clipped);
  EXPECT_EQ(drawn.clipped, clipped);
  return drawn;
}

TEST(FacetClusters, LeaveOutWhatNoPixelShows) {
  Random random(3);
  const TriangleMesh mesh = MakeBodies(40, &random);
  const FacetClusters clusters(mesh);
  for (int trial = 0; trial < 20; ++trial) {
    const Vector3d eye = 10 * RandomPoint(&random).cast<double>().array() - 5;
    const View view = LookAt(eye, RandomPoint(&random).cast<double>(), 80, 60,
                             trial % 2 == 0 ? 40 : 150);
    const std::vector<FacetRange> ranges = clusters.InFrustum(view);
    EXPECT_LT(NumFacets(ranges), mesh.facets.size() * 3 / 4);
    for (size_t i = 1; i < ranges.size(); ++i) {
      EXPECT_LT(ranges[i - 1].end, ranges[i].first);
    }
    ExpectAllIsDrawn(view, mesh, &random);
  }
}

// Facets of any size, of which the views show parts, also from behind.
TEST(FacetClusters, KeepWhatReachesBehindTheCamera) {
  Random random(4);
  TriangleMesh mesh;
  for (int i = 0; i < 30; ++i) {
    mesh = Union(mesh, MakeTriangles(50, [&](uint32_t, int) -> Vector3f {
                   return 6 * RandomPoint(&random).array() - 3;
                 }));
  }
  mesh = Union(mesh, MakeRoom());
  for (const View& view : RoomViews()) {
    ExpectAllIsDrawn(view, mesh, &random);
  }
}

// Bodies before and behind a wall: most of those behind it cost nothing, and no
// point of theirs is taken for nearest.
TEST(FacetClusters, LeaveOutWhatIsHidden) {
  Random random(5);
  const TriangleMesh mesh =
      Union(MakeBodies(40, &random),
            Shifted(Scaled(MakeSheet(8, 8), 10), Vector3f(-40.2f, -40.3f, 5)));
  const View view = LookAt({0.1, 0.2, 30}, {0, 0, 0}, 320, 240, 240);
  const DrawnFacets drawn = ExpectAllIsDrawn(view, mesh, &random);
  EXPECT_LT(NumFacets(drawn.ranges),
            NumFacets(FacetClusters(mesh).InFrustum(view)) * 3 / 4);
  std::vector<bool> is_drawn(mesh.facets.size(), false);
  ForEachFacet(drawn.ranges, [&](uint32_t i) { is_drawn[i] = true; });
  for (uint32_t i = 0; i < mesh.facets.size(); ++i) {
    if (is_drawn[i] ||
        !IsFacing(mesh, mesh.facets[i], view.Center(), kMinCosine)) {
      continue;
    }
    const double slope = PlaneSlope(view, mesh, mesh.facets[i]);
    for (const uint32_t vertex : mesh.facets[i]) {
      const Vector3d point =
          view.CamFromWorld(mesh.vertices[vertex].cast<double>());
      const Eigen::Vector2d pixel = view.ImageFromCam(point);
      EXPECT_TRUE(!IsWithin(view, pixel, 0) ||
                  !IsNearest(view, mesh, drawn, i, slope, pixel.x(), pixel.y(),
                             1 / point.z()));
    }
  }
}

TEST(FacetClusters, OfNothingHaveNoRanges) {
  EXPECT_TRUE(FacetClusters({}).InFrustum(RoomViews()[0]).empty());
}

// A hundred cameras in rising distances: those nearby show facets largest.
TEST(FindVisibleFacets, KeepsTheViewsThatShowAFacetLargest) {
  const TriangleMesh mesh = MakeSheet(4, 4);
  std::vector<View> views;
  for (int i = 0; i < 100; ++i) {
    const double height = 8 + 0.1 * ((i * 37) % 100);
    views.push_back(LookAt({2, 2.001, height}, {2, 2, 0}, 160, 120, 100));
  }
  const FacetVisibility visibility = VisibleFacets(mesh, views);
  for (size_t i = 0; i < mesh.facets.size(); ++i) {
    EXPECT_EQ(visibility[i].size(), kMaxViewsOfFacet);
    EXPECT_TRUE(std::ranges::is_sorted(visibility[i]));
    for (const uint32_t view : visibility[i]) {
      EXPECT_LT((view * 37) % 100, kMaxViewsOfFacet) << view;
    }
  }
}

// As if the parts had been drawn.
TEST(FindVisibleParts, AreVisibleWhereTheDrawnSurfaceIs) {
  const TriangleMesh sheet = MakeSheet(6, 6);
  const TriangleMesh mesh =
      Union(sheet, Shifted(Scaled(MakeBumpySphere(0.2f), 0.8f), {3, 3, 1.5f}));
  std::vector<View> views;
  for (const Vector3d& eye : {Vector3d(3, 3.01, 12), Vector3d(9, 2, 7),
                              Vector3d(-4, 5, 4), Vector3d(3, 1, 3)}) {
    views.push_back(LookAt(eye, {3, 3, 0.5}, 320, 240, 220));
  }
  // Each facet in three, from its centroid.
  TriangleMesh parts{mesh.vertices, {}};
  std::vector<uint32_t> drawn_facets;
  for (uint32_t i = 0; i < mesh.facets.size(); ++i) {
    const auto& [a, b, c] = mesh.facets[i];
    const auto middle = static_cast<uint32_t>(parts.vertices.size());
    parts.vertices.push_back(CentroidOf(mesh, mesh.facets[i]));
    for (const Facet& part :
         {Facet{a, b, middle}, Facet{b, c, middle}, Facet{c, a, middle}}) {
      parts.facets.push_back(part);
      drawn_facets.push_back(i);
    }
  }
  const VisibilityBuffers buffers(mesh, views, 0.1, SIZE_MAX);
  const FacetVisibility visibility =
      FindVisibleParts(buffers, parts, drawn_facets);
  const FacetVisibility expected = VisibleFacets(parts, views);
  size_t num_seen = 0;
  size_t num_different = 0;
  for (size_t i = 0; i < parts.facets.size(); ++i) {
    std::vector<uint32_t> difference;
    std::ranges::set_symmetric_difference(visibility[i], expected[i],
                                          std::back_inserter(difference));
    num_seen += expected[i].size();
    num_different += difference.size();
  }
  EXPECT_GT(num_seen, parts.facets.size());
  EXPECT_LT(num_seen, 3 * parts.facets.size());
  EXPECT_LT(num_different, num_seen / 200);
}

}  // namespace colmap_ext::facet_clusters_test
