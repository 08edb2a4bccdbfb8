#include "evaluation/mesh_evaluation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>

#include <gtest/gtest.h>

#include "scene/depth_maps.h"
#include "scene/view.h"
#include "spatial/bvh.h"
#include "tests/mesh/known_meshes.h"
#include "tests/random_vectors.h"
#include "tests/threads.h"

namespace colmap_ext::mesh_evaluation_test {

using Eigen::Vector3f;

// The square [0, 1] x [0, 1] at a height, of 2 n^2 facets, without those of
// x > end.
TriangleMesh Square(float height, uint32_t n = 10, float end = 1) {
  TriangleMesh mesh = Moved(MakeSheet(n, n), [&](const Vector3f& p) {
    return Vector3f(p.x() / static_cast<float>(n),
                    p.y() / static_cast<float>(n), height);
  });
  std::erase_if(mesh.facets, [&](const Facet& facet) {
    return std::ranges::any_of(CornersOf(mesh, facet), [&](const auto& corner) {
      return corner.x() > end + 1e-6f;
    });
  });
  return mesh;
}

// From above, all of the square and more.
std::vector<View> Cameras() {
  return {LookAtView({0.5, 0.4, 3}, {0.5, 0.5, 0}, {0, 1, 0}, 100, 80, 150),
          LookAtView({0.3, 0.5, 4}, {0.5, 0.5, 0}, {0, 1, 0}, 90, 110, 135)};
}

MeshEvaluation Evaluate(const TriangleMesh& mesh, const TriangleMesh& truth,
                        const std::vector<View>& views,
                        const MeshEvaluationOptions& options = {}) {
  return EvaluateMesh(options, mesh, {truth, nullptr}, views, {});
}

void ExpectAll(const DistanceStatistics& statistics, double distance) {
  EXPECT_NEAR(statistics.mean, distance, 1e-6);
  EXPECT_NEAR(statistics.median, distance, 1e-6);
  EXPECT_NEAR(statistics.percentile90, distance, 1e-6);
  EXPECT_GT(statistics.num_samples, 100);
}

TEST(EvaluateMesh, OfAShiftedPlaneIsTheShift) {
  for (const float shift : {0.0f, 0.01f, -0.03f}) {
    const MeshEvaluation evaluation = Evaluate(Square(shift, 7), Square(0), {});
    ASSERT_TRUE(evaluation.distances);
    ExpectAll(evaluation.distances->accuracy, std::abs(shift));
    ExpectAll(evaluation.distances->completeness, std::abs(shift));
    EXPECT_NEAR(evaluation.distances->AverageScore(), std::abs(shift), 1e-6);
    EXPECT_FALSE(evaluation.depths);
    EXPECT_TRUE(evaluation.topology.IsManifold());
    EXPECT_NEAR(evaluation.distances->spacing, 0.001 * std::sqrt(2), 1e-9);
    EXPECT_NEAR(evaluation.distances->max_distance, 0.05 * std::sqrt(2), 1e-7);
  }
}

TEST(EvaluateMesh, OfAShiftedPlaneThatCamerasSeeIsTheShift) {
  const MeshEvaluation evaluation =
      Evaluate(Square(-0.01f, 7), Square(0), Cameras(),
               {.stride = 2, .depth_thresholds = {0.005, 0.02}});
  ASSERT_TRUE(evaluation.distances && evaluation.depths);
  EXPECT_EQ(evaluation.num_views, 2);
  EXPECT_NEAR(evaluation.distances->accuracy.median, 0.01, 1e-6);
  EXPECT_NEAR(evaluation.distances->completeness.median, 0.01, 1e-6);
  EXPECT_EQ(evaluation.depths->num_within[0], 0);
  EXPECT_GT(evaluation.depths->Share(1), 0.97);
}

TEST(EvaluateMesh, CountsHolesAsIncomplete) {
  MeshEvaluationOptions options{.spacing = 0.004, .max_distance = 0.1};
  const MeshEvaluation clipped =
      Evaluate(Square(0, 10, 0.5f), Square(0), {}, options);
  ASSERT_TRUE(clipped.distances);
  EXPECT_NEAR(clipped.distances->accuracy.mean, 0, 1e-7);
  // Half is there; distances grow to 0.1 over the next tenth and stay there.
  EXPECT_NEAR(clipped.distances->completeness.mean, 0.1 * 0.05 + 0.4 * 0.1,
              1e-3);
  options.drop_beyond = true;
  const MeshEvaluation dropped =
      Evaluate(Square(0, 10, 0.5f), Square(0), {}, options);
  EXPECT_NEAR(dropped.distances->completeness.mean, 0.1 * 0.05 / 0.6, 1e-3);
  EXPECT_EQ(dropped.distances->completeness.num_beyond,
            clipped.distances->completeness.num_beyond);
}

TEST(EvaluateMesh, CountsOnlyWhatIsObservable) {
  Observability observability;
  observability.ground_plane = Eigen::Vector4d(-1, 0, 0, 0.5);  // x < 0.5
  ObservabilityMask& mask = observability.mask.emplace();
  mask.size = {6, 11, 1};
  mask.voxels.resize(66, 1);
  mask.resolution = 0.1;
  const TriangleMesh mesh = Moved(Square(0), [](const Vector3f& p) {
    return Vector3f(p.x(), p.y(), p.x() > 0.55f ? 0.04f : 0);
  });
  const MeshEvaluationOptions options{.spacing = 0.004};
  const MeshEvaluation evaluation =
      EvaluateMesh(options, mesh, {Square(0), nullptr}, {}, observability);
  EXPECT_LT(evaluation.distances->accuracy.mean, 2e-3);
  EXPECT_LT(evaluation.distances->completeness.mean, 1e-7);
  EXPECT_GT(Evaluate(mesh, Square(0), {}, options).distances->accuracy.mean,
            0.01);
}

TEST(EvaluateMesh, TakesPointsAsTheTruth) {
  TriangleMesh points = {Square(0, 200).vertices, {}};
  points.vertices.emplace_back(std::numeric_limits<float>::quiet_NaN(), 0, 0);
  points.vertices.emplace_back(0.5f, 0.5f, 100);  // behind the cameras
  const MeshEvaluationOptions options{.spacing = 0.002, .max_distance = 0.05};
  const MeshEvaluation evaluation =
      Evaluate(Square(0.01f), points, Cameras(), options);
  ASSERT_TRUE(evaluation.distances);
  EXPECT_FALSE(evaluation.depths);
  ExpectAll(evaluation.distances->completeness, 0.01);
  EXPECT_NEAR(evaluation.distances->accuracy.mean, 0.01, 5e-4);
  EXPECT_EQ(Evaluate(Square(0.01f), points, {}, options)
                .distances->completeness.num_beyond,
            1);
}

TEST(EvaluateMesh, TakesDepthMapsAsTheTruth) {
  const std::vector<View> views = Cameras();
  const Bvh truth(Square(0));
  const auto depth_maps = [&](size_t view) {
    return view == 0 ? DepthMap()
                     : RenderDepths(truth, ResizeView(views[1], 45, 55), 1);
  };
  const MeshEvaluation evaluation =
      EvaluateMesh({.depth_thresholds = {0.009, 0.011}},
                   Square(-0.01f, 10, 0.8f), {{}, depth_maps}, views, {});
  EXPECT_FALSE(evaluation.distances);
  ASSERT_TRUE(evaluation.depths);
  EXPECT_EQ(evaluation.num_views_without_depths, 1);
  EXPECT_EQ(evaluation.depths->num_within[0], 0);
  EXPECT_NEAR(evaluation.depths->Share(1), 0.8, 0.05);
  EXPECT_EQ(evaluation.depths->num_within[1] + evaluation.depths->num_missing,
            evaluation.depths->num_depths);
}

TEST(EvaluateMesh, DoesNotDependOnThreadsOrTheOrderOfFacets) {
  Random random(3);
  TriangleMesh mesh = Moved(Square(0, 30), [&](const Vector3f& p) {
    return Vector3f(p.x(), p.y(), 0.01f * RandomPoint(&random).z());
  });
  ExpectSameForAnyThreads([&] {
    random.Shuffle(&mesh.facets);
    const auto distances = Evaluate(mesh, Square(0), Cameras()).distances;
    return std::tuple(distances->accuracy.mean, distances->accuracy.median,
                      distances->completeness.mean,
                      distances->completeness.num_samples);
  });
}

TEST(EvaluateMesh, RefusesWhatDoesNotFitTogether) {
  const std::vector<View> away = {
      LookAtView({0.5, 0.5, 3}, {0.5, 0.5, 6}, {0, 1, 0}, 100, 80, 150)};
  EXPECT_THROW(Evaluate(Square(0), Square(0), away), std::invalid_argument);
  EXPECT_THROW(Evaluate(Square(0), {{{1, 1, 1}}, {}}, {}),
               std::invalid_argument);
}

TEST(EvaluateMesh, LeavesOutFacetsThatAreNotFinite) {
  TriangleMesh mesh = Square(0);
  mesh.vertices[5].x() = std::numeric_limits<float>::infinity();
  const MeshEvaluation evaluation = Evaluate(mesh, Square(0), Cameras());
  EXPECT_GT(evaluation.num_dropped_facets, 0);
  EXPECT_EQ(evaluation.topology.num_non_finite_vertices, 1);
  EXPECT_NEAR(evaluation.distances->accuracy.mean, 0, 1e-6);
  EXPECT_EQ(VertexErrors(mesh, {Square(0), nullptr}, 0.5)[5], 0.5);
}

TEST(Summarize, ClipsOrDropsWhatIsBeyondAndIsNotANumberOfNothing) {
  const auto expect = [](bool drop_beyond, double mean, double median,
                         double percentile90) {
    const DistanceStatistics statistics =
        Summarize({10, 1, 4, 10, 3, 2}, 10, drop_beyond);
    EXPECT_EQ(statistics.num_samples, 6);
    EXPECT_EQ(statistics.num_beyond, 2);
    EXPECT_DOUBLE_EQ(statistics.mean, mean);
    EXPECT_DOUBLE_EQ(statistics.median, median);
    EXPECT_DOUBLE_EQ(statistics.percentile90, percentile90);
  };
  expect(false, 5, 3.5, 10);
  expect(true, 2.5, 2.5, 3.7);
  EXPECT_EQ(Summarize({5, 1, 2}, 10, false).median, 2);
  EXPECT_EQ(Summarize({5}, 10, false).percentile90, 5);
  for (const DistanceStatistics& statistics :
       {Summarize({}, 1, false), Summarize({1, 1}, 1, true)}) {
    EXPECT_TRUE(std::isnan(statistics.mean));
    EXPECT_TRUE(std::isnan(statistics.median));
    EXPECT_TRUE(std::isnan(statistics.percentile90));
  }
}

using Points = std::vector<Vector3f>;

TEST(Observability, OfAMaskIsThatOfTheNearestVoxel) {
  Observability observability;
  ObservabilityMask& mask = observability.mask.emplace();
  mask.size = {2, 3, 4};
  mask.voxels.resize(24, 0);
  mask.voxels[(1 * 3 + 2) * 4 + 3] = 1;  // (1, 2, 3)
  mask.origin = {10, 20, 30};
  mask.resolution = 0.5;
  Points points = {{10.5f, 21, 31.5f},   {10.7f, 20.8f, 31.3f},
                   {10.8f, 21, 31.5f},   {10, 20, 30},
                   {10.5f, 21, 31.9f},   {10.5f, 21, 1e30f},
                   {-10.5f, -21, -31.5f}};
  observability.RestrictMesh(&points);
  EXPECT_EQ(points, (Points{{10.5f, 21, 31.5f}, {10.7f, 20.8f, 31.3f}}));
}

TEST(Observability, OfTheTruthIsAboveTheGround) {
  Observability observability;
  observability.ground_plane = Eigen::Vector4d(0, 0, 2, -1);
  const Points all = {{0, 0, 0.6f}, {5, 5, 0.5f}, {0, 0, -1}};
  Points points = all;
  observability.RestrictTruth(&points);
  EXPECT_EQ(points, (Points{{0, 0, 0.6f}}));
  points = all;
  observability.RestrictMesh(&points);
  EXPECT_EQ(points, all);
}

TEST(SampleSurface, IsNowhereFartherThanTheSpacing) {
  constexpr double kSpacing = 0.05;
  Random random(2);
  for (int i = 0; i < 50; ++i) {
    TriangleMesh mesh =
        MakeTriangles(1, [&](uint32_t, int) { return RandomPoint(&random); });
    if (i % 5 == 0) {  // a sliver
      mesh.vertices[2] = 0.3f * mesh.vertices[0] + 0.7f * mesh.vertices[1] +
                         1e-4f * mesh.vertices[2];
    }
    const Bvh bvh(mesh);
    const std::vector<Vector3f> samples = SampleSurface(mesh, kSpacing);
    for (const Vector3f& sample : samples) {
      EXPECT_LT(bvh.Distance(sample, 1), 1e-6);
    }
    for (int k = 0; k < 100; ++k) {
      Vector3f weights = RandomPoint(&random);
      weights /= weights.sum();
      const Vector3f point =
          ValueAt(SurfacePoint{0, weights}, mesh, mesh.vertices);
      float nearest = 1;
      for (const Vector3f& sample : samples) {
        nearest = std::min(nearest, (sample - point).norm());
      }
      EXPECT_LT(nearest, kSpacing + 1e-6);
    }
  }
}

TEST(SampleSurface, OfADegenerateFacetIsOnItAndOfATinySpacingRefused) {
  const TriangleMesh mesh = {{{1, 2, 3}, {2, 2, 3}}, {{0, 0, 0}, {0, 1, 0}}};
  const std::vector<Vector3f> samples = SampleSurface(mesh, 0.5);
  ASSERT_GE(samples.size(), 2);
  EXPECT_EQ(samples[0], Vector3f(1, 2, 3));
  for (const Vector3f& sample : samples) {
    EXPECT_TRUE(sample.allFinite());
  }
  const TriangleMesh facet = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  EXPECT_THROW(SampleSurface(facet, 1e-8), std::invalid_argument);
}

std::array<float, 3> VoxelOf(const Vector3f& point, float spacing) {
  return {std::floor(point.x() / spacing), std::floor(point.y() / spacing),
          std::floor(point.z() / spacing)};
}

TEST(DownsampleByVoxels, KeepsTheMiddlemostPointOfEachIfTheGridIsCoarse) {
  constexpr float kSpacing = 0.5f;
  Random random(1);
  Points points = RandomPoints(5000, 64, &random);
  for (Vector3f& point : points) {
    point /= 16;  // many repeats
  }
  Points sampled = points;
  DownsampleByVoxels(kSpacing, &sampled);
  std::set<std::array<float, 3>> voxels, sampled_voxels;
  for (const Vector3f& point : points) {
    voxels.insert(VoxelOf(point, kSpacing));
  }
  for (const Vector3f& point : sampled) {
    EXPECT_TRUE(sampled_voxels.insert(VoxelOf(point, kSpacing)).second);
  }
  EXPECT_EQ(sampled_voxels, voxels);
  for (int i = 0; i < 5; ++i) {
    random.Shuffle(&points);
    Points again = points;
    DownsampleByVoxels(kSpacing, &again);
    EXPECT_EQ(again, sampled);
    DownsampleByVoxels(kSpacing, &again);
    EXPECT_EQ(again, sampled);
  }
  Points voxel = {{0.1f, 0.1f, 0.1f}, {0.2f, 0.2f, 0.3f}, {0.4f, 0, 0}};
  DownsampleByVoxels(kSpacing, &voxel);
  EXPECT_EQ(voxel, (Points{{0.2f, 0.2f, 0.3f}}));
  Points far = {{1e10f, 0, 0}};
  EXPECT_THROW(DownsampleByVoxels(0.1, &far), std::invalid_argument);
  far.clear();
  DownsampleByVoxels(0.1, &far);
  EXPECT_TRUE(far.empty());
}

// A tilted triangle in front of a camera.
TriangleMesh Triangle() {
  return {{{-1, -1, 0}, {1, -0.5f, 0.5f}, {0, 1, -0.3f}}, {{0, 1, 2}}};
}

View Camera() {
  return LookAtView({0.2, 0.1, 3}, {0, 0, 0}, {0, 1, 0}, 31, 22, 46.5);
}

TEST(RenderDepths, OfSomePixelsIsAPartOfAll) {
  const Bvh bvh(Triangle());
  const DepthMap all = RenderDepths(bvh, Camera(), 1);
  EXPECT_EQ(all.width, 31);
  EXPECT_EQ(all.height, 22);
  for (const int stride : {1, 2, 3, 5, 40}) {
    const DepthMap some = RenderDepths(bvh, Camera(), stride);
    const DepthMap part = Subsample(all, stride);
    EXPECT_EQ(some.width, part.width);
    EXPECT_EQ(some.height, part.height);
    ASSERT_EQ(some.depths.size(), part.depths.size());
    for (size_t i = 0; i < some.depths.size(); ++i) {
      EXPECT_FLOAT_EQ(some.depths[i], part.depths[i]);
    }
  }
}

TEST(PointsWhere, AreOnTheSurfaceAndInTheirPixels) {
  const TriangleMesh mesh = Triangle();
  const Bvh bvh(mesh);
  const View view = Camera();
  const DepthMap depths = RenderDepths(bvh, view, 3);
  const std::vector<Vector3f> points = PointsWhere(depths, depths, view);
  EXPECT_GT(points.size(), 10);
  for (const Vector3f& point : points) {
    EXPECT_LT(bvh.Distance(point, 1), 1e-6);
    const Eigen::Vector2d at =
        view.ImageFromCam(view.CamFromWorld(point.cast<double>()));
    for (const double x : at) {
      EXPECT_NEAR((x - 1.5) / 3, std::round((x - 1.5) / 3), 1e-4);
    }
  }
  const DepthMap nothing = RenderDepths(Bvh(TriangleMesh()), view, 3);
  EXPECT_TRUE(PointsWhere(depths, nothing, view).empty());
}

TEST(AddDepthErrors, CountsPixelsByTheirErrors) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  DepthErrors errors;
  errors.thresholds = {0.25, 1};
  const DepthMap truth{7, 1, 1, {2, 2, 2, 2, 2, 0, kNan}};
  const DepthMap mesh{7, 1, 1, {2, 2.25f, 1.5f, 3.5f, 0, 2, 2}};
  AddDepthErrors(truth, mesh, &errors);
  EXPECT_EQ(errors.num_depths, 5);
  EXPECT_EQ(errors.num_missing, 1);
  EXPECT_DOUBLE_EQ(errors.Share(0), 0.2);
  EXPECT_DOUBLE_EQ(errors.Share(1), 0.6);
  AddDepthErrors(truth, truth, &errors);
  EXPECT_DOUBLE_EQ(errors.Share(0), 0.6);
  EXPECT_DOUBLE_EQ(errors.Share(1), 0.8);
}

}  // namespace colmap_ext::mesh_evaluation_test
