#include "evaluation/surface_samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <stdexcept>

#include <gtest/gtest.h>

#include "spatial/bvh.h"
#include "tests/random.h"

namespace colmap_ext {
namespace surface_samples_test {

using Eigen::Vector3f;

Vector3f RandomPoint(Random* random) {
  return {static_cast<float>(random->Unit()),
          static_cast<float>(random->Unit()),
          static_cast<float>(random->Unit())};
}

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
      float u = static_cast<float>(random.Unit());
      float v = static_cast<float>(random.Unit());
      if (u + v > 1) {
        u = 1 - u;
        v = 1 - v;
      }
      const Vector3f point = (1 - u - v) * mesh.vertices[0] +
                             u * mesh.vertices[1] + v * mesh.vertices[2];
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

using Points = std::vector<Eigen::Vector3f>;

std::array<float, 3> VoxelOf(const Eigen::Vector3f& point, float spacing) {
  return {std::floor(point.x() / spacing), std::floor(point.y() / spacing),
          std::floor(point.z() / spacing)};
}

Points RandomPoints(Random* random) {
  Points points;
  for (int i = 0; i < 5000; ++i) {
    Eigen::Vector3f point;
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
  for (const Eigen::Vector3f& point : points) {
    voxels.insert(VoxelOf(point, kSpacing));
  }
  for (const Eigen::Vector3f& point : sampled) {
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

}  // namespace surface_samples_test
}  // namespace colmap_ext
