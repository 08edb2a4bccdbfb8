#include "evaluation/mesh_evaluation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>

#include <gtest/gtest.h>

#include "scene/view.h"
#include "spatial/bvh.h"
#include "tests/mesh/known_meshes.h"

namespace colmap_ext {
namespace surface_samples_test {

using Eigen::Vector3f;
using Points = std::vector<Vector3f>;

TEST(SampleSurface, IsNowhereFartherThanTheSpacing) {
  constexpr double kSpacing = 0.05;
  Random random(2);
  for (int i = 0; i < 50; ++i) {
    TriangleMesh mesh;
    for (int k = 0; k < 3; ++k) {
      mesh.vertices.push_back(RandomPoint(&random));
    }
    if (i % 5 == 0) {  // a sliver
      mesh.vertices[2] = 0.3f * mesh.vertices[0] + 0.7f * mesh.vertices[1] +
                         1e-4f * mesh.vertices[2];
    }
    mesh.facets = {{0, 1, 2}};
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

TEST(SampleSurface, OfADegenerateFacetIsOnIt) {
  const TriangleMesh mesh = {{{1, 2, 3}, {2, 2, 3}}, {{0, 0, 0}, {0, 1, 0}}};
  const std::vector<Vector3f> samples = SampleSurface(mesh, 0.5);
  ASSERT_GE(samples.size(), 2);
  EXPECT_EQ(samples[0], Vector3f(1, 2, 3));
  for (const Vector3f& sample : samples) {
    EXPECT_TRUE(sample.allFinite());
  }
}

TEST(SampleSurface, RefusesASpacingThatIsTooSmall) {
  const TriangleMesh mesh = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  EXPECT_THROW(SampleSurface(mesh, 1e-8), std::invalid_argument);
}

std::array<float, 3> VoxelOf(const Vector3f& point, float spacing) {
  return {std::floor(point.x() / spacing), std::floor(point.y() / spacing),
          std::floor(point.z() / spacing)};
}

Points RandomPoints(Random* random) {
  Points points;
  for (int i = 0; i < 5000; ++i) {
    Vector3f point;
    for (float& x : point) {
      x = static_cast<float>(random->Integer(-64, 64)) / 16;  // many repeats
    }
    points.push_back(point);
  }
  return points;
}

TEST(DownsampleByVoxels, KeepsTheMiddlemostPointOfEachInAnyOrder) {
  constexpr float kSpacing = 0.5f;
  Random random(1);
  Points points = RandomPoints(&random);
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
}

TEST(DownsampleByVoxels, RefusesAGridThatIsTooFine) {
  Points points = {{1e10f, 0, 0}};
  EXPECT_THROW(DownsampleByVoxels(0.1, &points), std::invalid_argument);
  points.clear();
  DownsampleByVoxels(0.1, &points);
  EXPECT_TRUE(points.empty());
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

TEST(ResizeView, SeesTheSameThroughAnotherSize) {
  const View view = Camera();
  const View resized = ResizeView(view, 62, 11);
  const Eigen::Vector3d point(0.1, 0.2, 2);
  const Eigen::Vector2d at = view.ImageFromCam(point);
  EXPECT_TRUE(resized.ImageFromCam(point).isApprox(
      Eigen::Vector2d(2 * at.x(), at.y() / 2)));
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

}  // namespace surface_samples_test
}  // namespace colmap_ext
