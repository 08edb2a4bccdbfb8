#include "delaunay/space_filling_curve.h"

#include <gtest/gtest.h>

#include "tests/delaunay/random_complex.h"

namespace colmap_ext {
namespace {

constexpr int kNumBits = 21;

uint64_t Interleave(const Eigen::Vector3f& point) {
  uint64_t key = 0;
  for (int bit = 0; bit < kNumBits; ++bit) {
    for (int axis = 0; axis < 3; ++axis) {
      const auto coordinate = static_cast<uint64_t>(point[axis]);
      key |= (coordinate >> bit & 1) << (3 * bit + axis);
    }
  }
  return key;
}

TEST(MortonKeys, InterleaveTheBits) {
  constexpr int kHalf = 1 << (kNumBits - 1);
  constexpr float kLast = 2 * kHalf - 1;
  Random random(1);
  std::vector<Eigen::Vector3f> points = RandomPoints(1000, kHalf - 1, &random);
  for (Eigen::Vector3f& point : points) {
    point.array() += kHalf;
  }
  points.emplace_back(0, 0, 0);
  points.emplace_back(kLast, kLast, kLast);
  const std::vector<uint64_t> keys = MortonKeys(points);
  for (size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(keys[i], Interleave(points[i]));
  }
}

TEST(MortonKeys, DoNotDependOnPlaceAndScale) {
  Random random(2);
  const std::vector<Eigen::Vector3f> points = RandomPoints(500, 1000, &random);
  std::vector<Eigen::Vector3f> moved = points;
  for (Eigen::Vector3f& point : moved) {
    point = 8 * point + Eigen::Vector3f(1000, -5000, 16000);
  }
  EXPECT_EQ(MortonKeys(moved), MortonKeys(points));
}

TEST(MortonKeys, OfPointsAtOnePlaceAreOne) {
  const std::vector<uint64_t> keys =
      MortonKeys(std::vector<Eigen::Vector3f>(3, {1, 2, 3}));
  EXPECT_EQ(keys, std::vector<uint64_t>(3, 0));
  EXPECT_TRUE(MortonKeys({}).empty());
}

}  // namespace
}  // namespace colmap_ext
