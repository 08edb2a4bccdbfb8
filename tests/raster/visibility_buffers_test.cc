#include "raster/visibility_buffers.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>
#include <Eigen/Geometry>

#include "raster/facet_id_buffer.h"
#include "spatial/bvh.h"
#include "tests/mesh/known_meshes.h"
#include "tests/raster/shown_facets.h"
#include "tests/raster/visible_facets.h"
#include "tests/threads.h"

namespace colmap_ext::visibility_buffers_test {

using Eigen::Vector2d;
using Eigen::Vector3d;

// All around the origin.
std::vector<View> ViewsAround(double distance) {
  std::vector<View> views;
  for (const Vector3d& direction :
       {Vector3d(1, 0.2, 0), Vector3d(0, 0.5, 1), Vector3d(-1, 0, 0.3),
        Vector3d(0.1, -0.6, -1), Vector3d(0.5, -1, 0.4)}) {
    views.push_back(
        LookAt(distance * direction.normalized(), {0, 0, 0}, 160, 120, 180));
  }
  return views;
}

Vector3d Centroid(const TriangleMesh& mesh, size_t facet) {
  return CentroidOf(mesh, mesh.facets[facet]).cast<double>();
}

bool IsSeen(const FacetVisibility& visibility, size_t facet, uint32_t view) {
  return std::ranges::count(visibility[facet], view) > 0;
}

double Cosine(const TriangleMesh& mesh, size_t facet, const View& view) {
  return ComputeFacetFrame(mesh, mesh.facets[facet])
      .normal.dot((view.Center() - Centroid(mesh, facet)).normalized());
}

// A convex body hides nothing of itself but what it turns away.
TEST(FindVisibleFacets, SeesOfASphereWhatFacesTheCamera) {
  const TriangleMesh mesh = MakeBumpySphere(0.2f, 0);
  const std::vector<View> views = ViewsAround(5);
  for (const double min_cosine : {0.02, 0.1, 0.5}) {
    const FacetVisibility visibility = VisibleFacets(mesh, views, min_cosine);
    ASSERT_EQ(visibility.offsets.size(), mesh.facets.size() + 1);
    for (size_t facet = 0; facet < mesh.facets.size(); ++facet) {
      for (uint32_t i = 0; i < views.size(); ++i) {
        const double cosine = Cosine(mesh, facet, views[i]);
        if (std::abs(cosine - min_cosine) > 1e-6) {
          EXPECT_EQ(IsSeen(visibility, facet, i), cosine > min_cosine);
        }
      }
    }
  }
}

TEST(FindVisibleFacets, SeesNothingBehindAnotherFacet) {
  // Two sheets that face each other's backs, of one pixel's width apart and
  // more.
  const TriangleMesh sheet =
      Scaled(Shifted(MakeSheet(6, 6), {-3, -3, 0}), 1 / 6.0f);
  const TriangleMesh behind = Shifted(Scaled(sheet, 0.8f), {0, 0, -0.3f});
  const TriangleMesh mesh = Union(behind, sheet);
  const std::vector<View> views = {
      LookAt({0.05, 0, 4}, {0, 0, 0}, 160, 120, 180),
      LookAt({4, 0, 0.4}, {0, 0, -0.15}, 160, 120, 180)};
  const FacetVisibility visibility = VisibleFacets(mesh, views, 0.01);
  const size_t num_behind = behind.facets.size();
  for (size_t i = 0; i < mesh.facets.size(); ++i) {
    EXPECT_EQ(IsSeen(visibility, i, 0), i >= num_behind) << i;
    EXPECT_TRUE(IsSeen(visibility, i, 1)) << i;
  }
}

// Of a surface with parts before others.
TEST(FindVisibleFacets, AgreesWithRays) {
  const TriangleMesh mesh = MakeRoundTorus(0.15f);
  const Bvh bvh(mesh);
  const std::vector<View> views = ViewsAround(4);
  const FacetVisibility visibility = VisibleFacets(mesh, views);
  int num_seen = 0;
  int num_hidden = 0;
  for (size_t facet = 0; facet < mesh.facets.size(); ++facet) {
    for (uint32_t i = 0; i < views.size(); ++i) {
      if (!(Cosine(mesh, facet, views[i]) > 0.101)) {
        EXPECT_TRUE(!IsSeen(visibility, facet, i) ||
                    Cosine(mesh, facet, views[i]) > 0.099);
        continue;
      }
      const Vector3d in_camera = views[i].CamFromWorld(Centroid(mesh, facet));
      const DepthRange first =
          DepthsAround(bvh, views[i], views[i].ImageFromCam(in_camera));
      if (first.nearest > in_camera.z() - 0.25) {
        ++num_seen;
        EXPECT_TRUE(IsSeen(visibility, facet, i));
      } else if (first.farthest < in_camera.z() - 0.4) {
        ++num_hidden;
        EXPECT_FALSE(IsSeen(visibility, facet, i));
      }
    }
  }
  EXPECT_GT(num_seen, 500);
  EXPECT_GT(num_hidden, 50);
}

// Nothing is hidden in it: a view sees the facets whose centroids it shows, and
// of those that reach behind it all that it shows any part of.
TEST(FindVisibleFacets, SeesWallsThatReachBehindTheCamera) {
  const TriangleMesh room = MakeRoom();
  const std::vector<View> views = RoomViews();
  const FacetVisibility visibility = VisibleFacets(room, views);
  for (uint32_t i = 0; i < views.size(); ++i) {
    const DrawnFacets drawn = DrawFacets(views[i], room, 0.1);
    const std::vector<uint32_t> shown = ShownFacets(drawn);
    for (size_t facet = 0; facet < room.facets.size(); ++facet) {
      const bool is_clipped = std::ranges::binary_search(drawn.clipped, facet);
      if (is_clipped && std::ranges::count(shown, facet) > 500) {
        EXPECT_TRUE(IsSeen(visibility, facet, i)) << i << " " << facet;
      } else if (std::ranges::count(shown, facet) == 0) {
        EXPECT_FALSE(IsSeen(visibility, facet, i)) << i << " " << facet;
      }
    }
  }
}

TEST(FindVisibleFacets, KeepsFromTheBorder) {
  const TriangleMesh mesh = MakeBumpySphere(0.2f, 0);
  const View view = LookAt({0, 0, -2}, {0.4, 0.3, 0}, 100, 80, 150);
  const FacetVisibility visibility = VisibleFacets(mesh, {view});
  int num_beside = 0;
  for (size_t i = 0; i < mesh.facets.size(); ++i) {
    const Vector3d in_camera = view.CamFromWorld(Centroid(mesh, i));
    const Vector2d pixel = view.ImageFromCam(in_camera);
    const double distance =
        std::min({pixel.x(), pixel.y(), view.width - pixel.x(),
                  view.height - pixel.y()}) -
        kVisibilityBorder;
    if (Cosine(mesh, i, view) > 0.11 && std::abs(distance) > 1e-3) {
      num_beside += distance < 0;
      EXPECT_EQ(IsSeen(visibility, i, 0), distance > 0);
    }
  }
  EXPECT_GT(num_beside, 5);
}

TEST(FindVisibleFacets, OfEachViewDoNotDependOnTheOthersNorOnThreads) {
  const TriangleMesh mesh = MakeRoundTorus(0.15f);
  const std::vector<View> views = ViewsAround(4);
  const FacetVisibility expected = VisibleFacets(mesh, views);
  for (size_t i = 0; i < mesh.facets.size(); ++i) {
    const auto row = expected[i];
    EXPECT_TRUE(std::ranges::is_sorted(row));
    EXPECT_EQ(std::adjacent_find(row.begin(), row.end()), row.end());
  }
  ExpectSameForAnyThreads([&] { return VisibleFacets(mesh, views); });
  for (uint32_t i = 0; i < views.size(); ++i) {
    const FacetVisibility alone = VisibleFacets(mesh, {views[i]});
    for (size_t facet = 0; facet < mesh.facets.size(); ++facet) {
      EXPECT_EQ(IsSeen(alone, facet, 0), IsSeen(expected, facet, i));
    }
  }
}

TEST(FindVisibleFacets, OfNothingIsEmpty) {
  EXPECT_EQ(VisibleFacets(TriangleMesh(), ViewsAround(4)).offsets,
            std::vector<uint64_t>{0});
  EXPECT_TRUE(VisibleFacets(MakeCube(), {}).values.empty());
}

std::vector<View> SmallViews() {
  return {LookAt({0, 0.5, 4}, {0, 0, 0}, 60, 40, 60),
          LookAt({4, 0, 0.4}, {0, 0, 0}, 50, 40, 60),
          LookAt({-3, 1, -2}, {0, 0, 0}, 40, 40, 60)};
}

// Whatever the memory and whoever asks.
TEST(VisibilityBuffers, AreThoseOfDrawFacets) {
  const TriangleMesh mesh = MakeBumpySphere(0.3f);
  for (const size_t max_memory : {size_t{0}, size_t{30000}, SIZE_MAX}) {
    const VisibilityBuffers buffers(mesh, SmallViews(), 0.1, max_memory);
    buffers.DrawAhead();
    tbb::parallel_for(0, 12, [&](int i) {
      const DrawnFacets expected = DrawFacets(SmallViews()[i % 3], mesh, 0.1);
      const auto drawn = buffers.Get(i % 3);
      EXPECT_EQ(drawn->facets, expected.facets);
      EXPECT_EQ(drawn->min_cosine, expected.min_cosine);
    });
  }
}

TEST(VisibilityBuffers, AreKeptWhereThereIsRoom) {
  const VisibilityBuffers kept(MakeBumpySphere(0.3f), SmallViews(), 0.1,
                               SIZE_MAX);
  const std::weak_ptr<const FacetIdBuffer> first = kept.Get(0);
  kept.Get(1);
  EXPECT_EQ(kept.Get(0), first.lock());
  const VisibilityBuffers dropped(MakeBumpySphere(0.3f), SmallViews(), 0.1, 0);
  const std::weak_ptr<const FacetIdBuffer> second = dropped.Get(0);
  dropped.Get(1);
  EXPECT_TRUE(second.expired());
}

TEST(FacetFrames, HaveUnitNormalsToFreeSpaceAndBarycentricCoordinates) {
  Random random(1);
  const TriangleMesh mesh = RandomSoup(20, 60, true, &random);
  const std::vector<FacetFrame> frames = ComputeFacetFrames(mesh);
  ASSERT_EQ(frames.size(), mesh.facets.size());
  for (size_t i = 0; i < frames.size(); ++i) {
    const auto [a, b, c] = CornersOf<double>(mesh, mesh.facets[i]);
    EXPECT_EQ(frames[i].corner, a);
    EXPECT_NEAR(frames[i].normal.norm(), 1, 1e-12);
    EXPECT_NEAR(frames[i].normal.dot(b - a), 0, 1e-12);
    EXPECT_NEAR(frames[i].normal.dot(c - a), 0, 1e-12);
    EXPECT_GT(frames[i].normal.dot((b - a).cross(c - a)), 0);
  }
  const FacetFrame up =
      ComputeFacetFrame({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {}}, {0, 1, 2});
  EXPECT_EQ(up.normal, Vector3d::UnitZ());
  // Points are sums of the corners by their barycentric coordinates; what lies
  // off the plane has those of its foot.
  for (size_t i = 0; i < frames.size(); ++i) {
    const auto corners = CornersOf<double>(mesh, mesh.facets[i]);
    for (int k = 0; k < 3; ++k) {
      EXPECT_LT((Barycentric(frames[i], corners[k]) - Vector3d::Unit(k)).norm(),
                1e-9);
    }
    for (int trial = 0; trial < 5; ++trial) {
      const double b = 3 * random.Unit() - 1;
      const double c = 3 * random.Unit() - 1;
      const Vector3d weights(1 - b - c, b, c);
      const Vector3d point = random.Unit() * frames[i].normal +
                             weights[0] * corners[0] + b * corners[1] +
                             c * corners[2];
      EXPECT_LT((Barycentric(frames[i], point) - weights).norm(), 1e-8);
    }
  }
}

TEST(FacetFrames, OfDegenerateFacetsAreZero) {
  const TriangleMesh line = {{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}, {{0, 1, 2}}};
  const FacetFrame frame = ComputeFacetFrames(line).front();
  EXPECT_EQ(frame.normal, Vector3d::Zero());
  EXPECT_EQ(Barycentric(frame, {3, 4, 5}), Vector3d::UnitX());
  EXPECT_TRUE(ComputeFacetFrames(TriangleMesh()).empty());
}

TEST(FacetFrames, ScaleWithTheScene) {
  const TriangleMesh cube = MakeCube();
  const std::vector<FacetFrame> frames = ComputeFacetFrames(cube);
  const std::vector<FacetFrame> scaled = ComputeFacetFrames(Scaled(cube, 1024));
  for (size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(scaled[i].normal, frames[i].normal);
    EXPECT_EQ(1024 * scaled[i].gradient_1, frames[i].gradient_1);
    EXPECT_EQ(1024 * scaled[i].gradient_2, frames[i].gradient_2);
  }
}

}  // namespace colmap_ext::visibility_buffers_test
