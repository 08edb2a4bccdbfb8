#include "evaluation/observability.h"

#include <gtest/gtest.h>

namespace colmap_ext {
namespace observability_test {

using Points = std::vector<Eigen::Vector3f>;

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

}  // namespace observability_test
}  // namespace colmap_ext
