#include "evaluation/voxel_downsampling.h"

#include <array>
#include <cmath>
#include <set>
#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/random.h"

namespace colmap_ext {
namespace voxel_downsampling_test {

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

}  // namespace voxel_downsampling_test
}  // namespace colmap_ext
