#include "raster/facet_id_buffer.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "spatial/bvh.h"
#include "tests/mesh/known_meshes.h"
#include "tests/peak_memory.h"
#include "tests/raster/shown_facets.h"
#include "tests/raster/visible_facets.h"

namespace colmap_ext::facet_id_buffer_test {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector3f;

// At the origin, along z; (u, v) is seen at (u - 32, v - 24, 64) / 64.
View StraightView() {
  View view = LookAt({0, 0, 0}, {0, 0, 1}, 64, 48, 64);
  view.cam_from_world_rotation.setIdentity();
  return view;
}

// A point of the world, for StraightView().
Vector3f PointAt(double u, double v, double depth) {
  return (depth / 64 * Vector3d(u - 32, v - 24, 64)).cast<float>();
}

TriangleMesh RandomTriangles(uint32_t num_facets, Random* random) {
  TriangleMesh mesh;
  for (uint32_t i = 0; i < num_facets; ++i) {
    const double depth = 1 + 4 * random->Unit();
    const double u = 64 * random->Unit();
    const double v = 48 * random->Unit();
    for (int k = 0; k < 3; ++k) {
      mesh.vertices.push_back(PointAt(u + 40 * random->Unit() - 20,
                                      v + 40 * random->Unit() - 20,
                                      depth * (1 + 0.2 * random->Unit())));
    }
    mesh.facets.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return mesh;
}

// What the ray through a pixel's centre meets first.
struct Hit {
  uint32_t facet = kNone;
  double inverse_depth = 0;
  bool is_clear = true;  // however vertices are moved by 1/512 px
};

Hit Cast(const View& view, const TriangleMesh& mesh, int row, int col) {
  const Vector2d pixel(col + 0.5, row + 0.5);
  std::vector<std::pair<double, uint32_t>> hits;
  Hit hit;
  for (uint32_t i = 0; i < mesh.facets.size(); ++i) {
    const double inverse_depth = InverseDepthAt(view, mesh, i, pixel);
    for (const auto& [u, v] : {std::pair(1, 1), {1, -1}, {-1, 1}, {-1, -1}}) {
      const Vector2d beside = pixel + 0.01 * Vector2d(u, v);
      hit.is_clear &=
          (InverseDepthAt(view, mesh, i, beside) > 0) == (inverse_depth > 0);
    }
    if (inverse_depth > 0) {
      hits.emplace_back(inverse_depth, i);
    }
  }
  if (!hits.empty()) {
    std::ranges::sort(hits, std::greater());
    std::tie(hit.inverse_depth, hit.facet) = hits[0];
    hit.is_clear &= hits.size() < 2 || hits[1].first < 0.99 * hits[0].first;
  }
  return hit;
}

void ExpectAsCast(const View& view, const TriangleMesh& mesh) {
  const DrawnFacets drawn = DrawFacets(view, mesh, 0.1);
  ASSERT_EQ(drawn.width, view.width);
  ASSERT_EQ(drawn.height, view.height);
  int num_clear = 0;
  int num_hits = 0;
  ForEachPixel(view, [&](int row, int col) {
    const Hit hit = Cast(view, mesh, row, col);
    const size_t i = drawn.Index(row, col);
    EXPECT_EQ(drawn.facets[i] == kNone, drawn.inverse_depths[i] == 0);
    if (hit.is_clear) {
      ++num_clear;
      num_hits += hit.facet != kNone;
      EXPECT_EQ(drawn.facets[i], hit.facet) << row << " " << col;
      EXPECT_NEAR(drawn.inverse_depths[i], hit.inverse_depth,
                  0.01 * hit.inverse_depth);
    }
  });
  EXPECT_GT(num_clear, 0.7 * view.width * view.height);
  EXPECT_GT(num_hits, 0.3 * view.width * view.height);
}

TEST(FacetIds, KeepsEachIndexInThreeOrFourBytes) {
  for (const uint32_t num_facets : {5U, 0xFFFFFEU, 0xFFFFFFU, 0xFFFFFFFFU}) {
    FacetIds ids(4, num_facets);
    EXPECT_EQ(ids.size(), 4);
    EXPECT_EQ(ids.BytesOfOne(), num_facets < 0xFFFFFF ? 3 : 4);
    ids.Set(1, num_facets - 1);
    ids.Set(2, 1);
    ids.Set(3, num_facets - 2);
    EXPECT_EQ(ids[0], kNone);
    EXPECT_EQ(ids[1], num_facets - 1);
    EXPECT_EQ(ids[2], 1);
    EXPECT_EQ(ids[3], num_facets - 2);
    ids.Set(1, kNone);
    EXPECT_EQ(ids[1], kNone);
    EXPECT_EQ(ids[2], 1);
  }
  EXPECT_EQ(FacetIds().size(), 0);
}

TEST(DrawFacets, ShowsWhatRaysMeetFirstAlsoOfARoom) {
  Random random(1);
  for (int trial = 0; trial < 5; ++trial) {
    ExpectAsCast(StraightView(), RandomTriangles(20, &random));
  }
  ExpectAsCast(LookAt({1, 2, -3}, {0.1, 0, 0}, 60, 50, 90),
               MakeRoundTorus(0.3f));
  for (const View& view : RoomViews()) {
    ExpectAsCast(view, MakeRoom());
    const DrawnFacets drawn = DrawFacets(view, MakeRoom(), 0.1);
    EXPECT_EQ(std::ranges::count(ShownFacets(drawn), kNone), 0);
    EXPECT_GT(drawn.clipped.size(), 0);
    EXPECT_EQ(drawn.clipped, FindClippedFacets(view, MakeRoom(), drawn.ranges));
    for (const uint32_t facet : drawn.clipped) {
      EXPECT_TRUE(IsFacing(view, MakeRoom(), drawn, facet));
    }
  }
}

// Of random triangles all around the camera.
TEST(DrawFacets, ShowsWhatRaysMeetFirstWhereFacetsReachBehind) {
  Random random(8);
  for (int trial = 0; trial < 5; ++trial) {
    const TriangleMesh mesh = MakeTriangles(40, [&](uint32_t, int) -> Vector3f {
      return 6 * RandomPoint(&random).array() - 3;
    });
    ExpectAsCast(StraightView(), mesh);
    EXPECT_GT(DrawFacets(StraightView(), mesh, 0.1).clipped.size(), 2);
  }
}

TEST(DrawFacets, LetsTheNearestWinInWhateverOrderAndOfEqualsTheFirst) {
  Random random(2);
  const TriangleMesh mesh = RandomTriangles(40, &random);
  const View view = StraightView();
  const DrawnFacets expected = DrawFacets(view, mesh, 0.1);
  std::vector<uint32_t> order = Iota(mesh.facets.size());
  for (int trial = 0; trial < 5; ++trial) {
    random.Shuffle(&order);
    TriangleMesh shuffled = mesh;
    for (size_t i = 0; i < order.size(); ++i) {
      shuffled.facets[i] = mesh.facets[order[i]];
    }
    const DrawnFacets drawn = DrawFacets(view, shuffled, 0.1);
    EXPECT_EQ(drawn.inverse_depths, expected.inverse_depths);
    for (size_t i = 0; i < drawn.facets.size(); ++i) {
      EXPECT_EQ(drawn.facets[i] == kNone ? kNone : order[drawn.facets[i]],
                expected.facets[i]);
    }
    for (size_t i = 0; i < order.size(); ++i) {
      EXPECT_EQ(IsFacing(view, shuffled, drawn, i),
                IsFacing(view, mesh, expected, order[i]));
    }
  }
  TriangleMesh twice = mesh;
  Append(mesh.facets, &twice.facets);
  EXPECT_EQ(DrawFacets(view, twice, 0.1).facets, expected.facets);
}

// No pixel is drawn by two facets of a mesh that hides nothing of itself.
// \param is_covered  of a row and a column: they show a facet.
template <typename Function>
void ExpectCoveredOnce(const View& view, const TriangleMesh& mesh,
                       const Function& is_covered) {
  std::vector<int> counts(view.width * view.height, 0);
  for (const Facet& facet : mesh.facets) {
    const DrawnFacets drawn = DrawFacets(view, {mesh.vertices, {facet}}, 0);
    for (size_t i = 0; i < counts.size(); ++i) {
      counts[i] += drawn.facets[i] == 0 ? 1 : 0;
    }
  }
  const DrawnFacets whole = DrawFacets(view, mesh, 0);
  ForEachPixel(view, [&](int row, int col) {
    const size_t i = whole.Index(row, col);
    EXPECT_LE(counts[i], 1) << row << " " << col;
    EXPECT_EQ(counts[i] == 1, whole.facets[i] != kNone) << row << " " << col;
    EXPECT_TRUE(counts[i] == 1 || !is_covered(row, col)) << row << " " << col;
  });
}

// Vertices in the middle of pixels, and edges through them, included.
TEST(DrawFacets, CoversEachPixelOfASheetOnce) {
  Random random(4);
  for (const bool is_jittered : {false, true}) {
    TriangleMesh sheet = MakeSheet(10, 14);
    for (Vector3f& vertex : sheet.vertices) {
      const double u = 2.5 + 4 * vertex.x();
      const double v = 3.5 + 4 * vertex.y();
      const double jitter = is_jittered ? 1.5 : 0;
      vertex = PointAt(u + jitter * std::round(4 * random.Unit() - 2) / 2,
                       v + jitter * std::round(4 * random.Unit() - 2) / 2, 2);
    }
    ExpectCoveredOnce(StraightView(), sheet, [](int row, int col) {
      return row > 5 && row < 40 && col > 5 && col < 55;
    });
  }
}

// A floor below and behind the camera: what lies at the camera's plane is drawn
// by a part.
TEST(DrawFacets, CoversEachPixelOfAFloorOnce) {
  Random random(9);
  for (const double jitter : {0.0, 0.4}) {
    TriangleMesh floor = MakeSheet(8, 8);
    for (Vector3f& vertex : floor.vertices) {
      vertex = Vector3d(vertex.x() - 4 + jitter * random.Unit(), 0.3,
                        vertex.y() - 4 + jitter * random.Unit())
                   .cast<float>();
    }
    const View view = LookAt({0.1, 0, 0.2}, {0.2, 0.25, 1}, 64, 48, 20);
    EXPECT_GT(DrawFacets(view, floor, 0.1).clipped.size(), 1);
    ExpectCoveredOnce(view, floor,
                      [&](int row, int) { return row >= view.height / 2; });
  }
}

TEST(DrawFacets, ShowsBothSidesButOneFaces) {
  Random random(5);
  const TriangleMesh mesh = RandomTriangles(20, &random);
  TriangleMesh turned = mesh;
  for (Facet& facet : turned.facets) {
    std::swap(facet[1], facet[2]);
  }
  const DrawnFacets front = DrawFacets(StraightView(), mesh, 0);
  const DrawnFacets back = DrawFacets(StraightView(), turned, 0);
  EXPECT_EQ(front.facets, back.facets);
  EXPECT_EQ(front.inverse_depths, back.inverse_depths);
  for (const uint32_t facet : ShownFacets(front)) {
    if (facet != kNone) {
      EXPECT_NE(IsFacing(StraightView(), mesh, front, facet),
                IsFacing(StraightView(), turned, back, facet));
    }
  }
}

TEST(DrawFacets, TellsWhichFaceTheCameraEnough) {
  for (const double degrees : {0.0, 30.0, 55.0, 65.0, 89.0}) {
    const double turn = degrees * std::numbers::pi / 180;
    // With its centroid straight ahead.
    TriangleMesh mesh =
        Moved({{{-1, -1, 0}, {0, 2, 0}, {1, -1, 0}}, {{0, 1, 2}}},
              [&](const Vector3f& corner) -> Vector3f {
                return Eigen::AngleAxisf(turn, Vector3f::UnitX()) * corner +
                       Vector3f(0, 0, 9);
              });
    const auto is_facing = [&](double min_cosine) {
      return IsFacing(StraightView(), mesh,
                      DrawFacets(StraightView(), mesh, min_cosine), 0);
    };
    EXPECT_EQ(is_facing(0.5), degrees < 60);
    EXPECT_TRUE(is_facing(0));
    mesh.facets = {{0, 2, 1}};
    EXPECT_FALSE(is_facing(0));
  }
}

TEST(DrawFacets, ShowsNothingBehindTheCamera) {
  Random random(6);
  const TriangleMesh mesh = RandomTriangles(10, &random);
  const DrawnFacets front = DrawFacets(StraightView(), mesh, 0);
  EXPECT_NE(ShownFacets(front),
            std::vector<uint32_t>(front.facets.size(), kNone));
  // The same through the camera's center.
  const DrawnFacets drawn = DrawFacets(StraightView(), Scaled(mesh, -1), 0);
  EXPECT_EQ(ShownFacets(drawn),
            std::vector<uint32_t>(drawn.facets.size(), kNone));
  EXPECT_TRUE(drawn.clipped.empty());
}

// Each thread that draws would take it.
TEST(DrawFacets, TakesNoMemoryForEachVertex) {
  constexpr size_t kNumVertices = 4000000;
  TriangleMesh mesh = {{PointAt(5, 5, 2), PointAt(25, 5, 2), PointAt(5, 25, 2)},
                       {{0, 1, 2}}};
  const DrawnFacets expected = DrawFacets(StraightView(), mesh, 0);
  mesh.vertices.resize(kNumVertices, Vector3f(1, 1, 1));
  std::swap(mesh.vertices[0], mesh.vertices.back());
  mesh.facets[0][0] = kNumVertices - 1;
  const size_t before = PeakMemory();
  EXPECT_EQ(DrawFacets(StraightView(), mesh, 0).facets, expected.facets);
  EXPECT_LT(PeakMemory() - before, 4 * kNumVertices);
}

TEST(DrawFacets, ShowsNothingOfWhatHasNoAreaOrLiesBesideTheImage) {
  const TriangleMesh line = {
      {PointAt(5, 5, 2), PointAt(15, 15, 2), PointAt(25, 25, 2)}, {{0, 1, 2}}};
  const TriangleMesh beside = {
      {PointAt(70, 5, 2), PointAt(90, 5, 2), PointAt(70, 25, 2)}, {{0, 1, 2}}};
  for (const TriangleMesh& mesh : {line, beside, TriangleMesh()}) {
    const DrawnFacets drawn = DrawFacets(StraightView(), mesh, 0);
    EXPECT_EQ(ShownFacets(drawn), std::vector<uint32_t>(64 * 48, kNone));
  }
}

TEST(DrawFacets, DoesNotDependOnTheScale) {
  const TriangleMesh mesh = MakeRoundTorus(0.3f);
  View view = LookAt({1, 2, -3}, {0.1, 0, 0}, 60, 50, 70);
  const DrawnFacets expected = DrawFacets(view, mesh, 0.1);
  view.cam_from_world_translation *= 1024;
  const TriangleMesh scaled = Scaled(mesh, 1024);
  DrawnFacets drawn = DrawFacets(view, scaled, 0.1);
  EXPECT_EQ(drawn.facets, expected.facets);
  for (uint32_t i = 0; i < mesh.facets.size(); ++i) {
    View unscaled = view;
    unscaled.cam_from_world_translation /= 1024;
    EXPECT_EQ(IsFacing(view, scaled, drawn, i),
              IsFacing(unscaled, mesh, expected, i));
  }
  for (float& inverse_depth : drawn.inverse_depths) {
    inverse_depth *= 1024;
  }
  EXPECT_EQ(drawn.inverse_depths, expected.inverse_depths);
}

// Of facets that are drawn as a whole to the last bit but for rounding.
TEST(DepthOf, IsWhatIsDrawn) {
  Random random(3);
  std::vector<std::pair<View, TriangleMesh>> scenes = {
      {StraightView(), RandomTriangles(20, &random)},
      {LookAt({1, 3, -2}, {0, 0, 0}, 100, 80, 120), MakeRoundTorus(0.15f)}};
  for (const View& view : RoomViews()) {
    scenes.emplace_back(view, MakeRoom());
  }
  for (const auto& [view, mesh] : scenes) {
    const DrawnFacets drawn = DrawFacets(view, mesh, 0.1);
    ForEachPixel(view, [&](int row, int col) {
      const size_t pixel = drawn.Index(row, col);
      const uint32_t facet = drawn.facets[pixel];
      if (facet == kNone) {
        return;
      }
      const double depth = 1 / drawn.inverse_depths[pixel];
      // Corners of clipped parts are off by up to 1 / 512 px.
      const double tolerance =
          std::ranges::binary_search(drawn.clipped, facet)
              ? 0.004 * PlaneSlope(view, mesh, mesh.facets[facet]) * depth
              : 0;
      EXPECT_NEAR(DepthOf(view, mesh, mesh.facets[facet]).At(row, col) * depth,
                  1, 1e-6 + tolerance);
    });
  }
}

TEST(PlaneSlope, IsTheLargestDifferenceOfThePlanesDepth) {
  const TriangleMesh mesh = {
      {PointAt(5, 5, 2), PointAt(35, 15, 4), PointAt(15, 35, 3)}, {{0, 1, 2}}};
  const View view = StraightView();
  const Eigen::Vector3d by_pixel =
      InverseDepthByPixel(view, mesh, mesh.facets[0]);
  for (const Vector3f& vertex : mesh.vertices) {
    const Eigen::Vector3d in_camera = view.CamFromWorld(vertex.cast<double>());
    EXPECT_NEAR(by_pixel.dot(view.ImageFromCam(in_camera).homogeneous()) *
                    in_camera.z(),
                1, 1e-6);
  }
  double largest = 0;
  for (const auto& [u, v] : {std::pair(1, 1), {1, -1}}) {
    largest = std::max(largest, std::abs(by_pixel.dot(Vector3d(u, v, 0))));
  }
  EXPECT_NEAR(PlaneSlope(view, mesh, mesh.facets[0]), largest, 1e-12);
}

TEST(IsNearest, IsFalseWhereThePixelIsMasked) {
  const TriangleMesh mesh = {
      {PointAt(10, 10, 2), PointAt(10, 40, 2), PointAt(50, 10, 2)},
      {{0, 1, 2}}};
  const View view = StraightView();
  DrawnFacets drawn = DrawFacets(view, mesh, 0);
  GrayImage mask{view.width, view.height,
                 std::vector<uint8_t>(drawn.facets.size(), 255)};
  mask.pixels[drawn.Index(15, 15)] = 0;
  EraseMasked(mask, &drawn);
  const double slope = PlaneSlope(view, mesh, mesh.facets[0]);
  EXPECT_EQ(drawn.facets[drawn.Index(15, 15)], kNone);
  EXPECT_FALSE(IsNearest(view, mesh, drawn, 0, slope, 15.5, 15.5, 0.5));
  EXPECT_TRUE(IsNearest(view, mesh, drawn, 0, slope, 16.5, 15.5, 0.5));
  EXPECT_TRUE(IsNearest(view, mesh, drawn, 0, slope, 1.5, 1.5, 0.5));
}

// Of random points on a surface with parts before others: all that nothing lies
// in front of are nearest, and none that something clearly does.
TEST(IsNearest, SeesWhatNothingLiesInFrontOf) {
  const TriangleMesh mesh = MakeRoundTorus(0.15f);
  const Bvh bvh(mesh);
  Random random(7);
  const View view = LookAt({1, 3, -2}, {0, 0, 0}, 100, 80, 120);
  const DrawnFacets drawn = DrawFacets(view, mesh, 0.1);
  const std::vector<FacetFrame> frames = ComputeFacetFrames(mesh);
  int num_visible = 0;
  int num_hidden = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const uint32_t facet = random.Below(mesh.facets.size());
    const double a = random.Unit();
    const double b = (1 - a) * random.Unit();
    const auto [first, second, third] =
        CornersOf<double>(mesh, mesh.facets[facet]);
    const Vector3d point = (1 - a - b) * first + a * second + b * third;
    const Vector3d in_camera = view.CamFromWorld(point);
    const Vector2d pixel = view.ImageFromCam(in_camera);
    const bool is_nearest = IsNearest(
        view, mesh, drawn, facet, PlaneSlope(view, mesh, mesh.facets[facet]),
        pixel.x(), pixel.y(), 1 / in_camera.z());
    const DepthRange around = DepthsAround(bvh, view, pixel);
    const Vector3d ray = (view.Center() - point).normalized();
    if (std::abs(frames[facet].normal.dot(ray)) < 0.2) {
      continue;
    }
    if (around.nearest > in_camera.z() - 0.2) {
      ++num_visible;
      EXPECT_TRUE(is_nearest) << facet;
    } else if (around.farthest < in_camera.z() - 0.4) {
      ++num_hidden;
      EXPECT_FALSE(is_nearest) << facet;
    }
  }
  EXPECT_GT(num_visible, 500);
  EXPECT_GT(num_hidden, 500);
}

// Of a facet that is parallel to the image, within two pixels' footprints of
// what is drawn there.
TEST(IsNearest, LeavesRoomForTwoPixels) {
  const auto triangle = [](double depth) -> TriangleMesh {
    return {{PointAt(10, 10, depth), PointAt(10, 40, depth),
             PointAt(50, 10, depth)},
            {{0, 1, 2}}};
  };
  for (const double margin : {0.0, 1.8, 2.2, 5.0}) {
    // The second facet by so many footprints behind the first.
    const double depth = 2 * (1 + margin / 64);
    const TriangleMesh mesh = Union(triangle(2), triangle(depth));
    const DrawnFacets drawn = DrawFacets(StraightView(), mesh, 0);
    EXPECT_EQ(drawn.facets[drawn.Index(15, 15)], 0);
    EXPECT_TRUE(IsNearest(StraightView(), mesh, drawn, 0,
                          PlaneSlope(StraightView(), mesh, mesh.facets[0]),
                          15.5, 15.5, 0.5));
    EXPECT_EQ(IsNearest(StraightView(), mesh, drawn, 1,
                        PlaneSlope(StraightView(), mesh, mesh.facets[1]), 15.5,
                        15.5, 1 / depth),
              margin < 2);
  }
}

}  // namespace colmap_ext::facet_id_buffer_test
