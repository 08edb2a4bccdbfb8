#include "tiles/ray_mask.h"

#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "tests/random_vectors.h"

namespace colmap_ext {
namespace ray_mask_test {

// In a cube.
Eigen::Vector3d Anywhere(double from, double to, Random* random) {
  return RandomVector(random, (to - from) / 2).array() + (from + to) / 2;
}

// Of a tetrahedron or a triangle.
Eigen::Vector3d Within(const std::vector<Eigen::Vector3d>& corners,
                       Random* random) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double total = 0;
  for (const Eigen::Vector3d& corner : corners) {
    const double weight = random->Unit() + 1e-9;
    sum += weight * corner;
    total += weight;
  }
  return sum / total;
}

TEST(RayMask, LeavesOutNoRayThroughWhatIsMarked) {
  Random random(1);
  const Eigen::AlignedBox3d bounds(Eigen::Vector3d(0, 0, 0),
                                   Eigen::Vector3d(10, 10, 1));
  for (int i = 0; i < 200; ++i) {
    RayMask mask(bounds);
    std::vector<Eigen::Vector3d> corners;
    const int num_corners = 3 + static_cast<int>(random.Below(2));
    for (int k = 0; k < num_corners; ++k) {
      corners.push_back(Anywhere(0, 1, &random).cwiseProduct(bounds.max()));
    }
    mask.Mark(corners);
    mask.Finish();
    for (int k = 0; k < 50; ++k) {
      const Eigen::Vector3d from = Anywhere(-5, 15, &random);
      const Eigen::Vector3d through = Within(corners, &random);
      const Eigen::Vector3d to = through + random.Unit() * (through - from);
      const Eigen::Vector3d direction = (to - from).normalized();
      EXPECT_TRUE(mask.MayPass(from, direction, (to - from).norm()));
      EXPECT_TRUE(mask.MayPass(to, -direction,
                               std::numeric_limits<double>::infinity()));
      EXPECT_TRUE(mask.MayTouch(Eigen::AlignedBox3d(through).extend(from)));
    }
  }
}

TEST(RayMask, LeavesOutMostRaysElsewhere) {
  Random random(2);
  RayMask mask({Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(10, 10, 10)});
  const std::vector<Eigen::Vector3d> corners = {
      {1, 1, 1}, {2, 1, 1}, {1, 2, 1}, {1, 1, 2}};
  mask.Mark(corners);
  mask.Finish();
  EXPECT_FALSE(
      mask.MayTouch({Eigen::Vector3d(5, 5, 5), Eigen::Vector3d(9, 9, 9)}));
  size_t num_crossing = 0;
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector3d from = Anywhere(0, 10, &random);
    const Eigen::Vector3d way = Anywhere(0, 10, &random) - from;
    num_crossing += mask.MayPass(from, way.normalized(), way.norm());
  }
  EXPECT_LT(num_crossing, 100u);
}

}  // namespace ray_mask_test
}  // namespace colmap_ext
