#include "spatial/orientation.h"

#include <cmath>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "tests/delaunay/exact.h"
#include "tests/random.h"

namespace colmap_ext {
namespace orientation_test {

using Eigen::Vector3f;

Vector3f IntegerPoint(int size, Random* random) {
  Vector3f point;
  for (int k = 0; k < 3; ++k) {
    point[k] = static_cast<float>(random->Integer(-size, size));
  }
  return point;
}

// Of any magnitude.
float AnyFloat(Random* random) {
  return std::ldexp(static_cast<float>(random->Unit() - 0.5),
                    random->Integer(-30, 30));
}

TEST(Side, IsExact) {
  Random random(1);
  int num_zeros = 0;
  for (const int size : {2, 10, 1 << 20}) {
    for (int trial = 0; trial < 20000; ++trial) {
      const Vector3f a = IntegerPoint(size, &random);
      const Vector3f b = IntegerPoint(size, &random);
      const Vector3f c = IntegerPoint(size, &random);
      // Half of the time in the plane, or next to it.
      const Vector3f d = random.Chance(0.5)
                             ? IntegerPoint(size, &random)
                             : Vector3f(a + b - c + IntegerPoint(1, &random));
      const int expected = -ExactOrientation(ToIntegers(a), ToIntegers(b),
                                             ToIntegers(c), ToIntegers(d));
      EXPECT_EQ(Side(a, b, c, d), expected);
      num_zeros += expected == 0 ? 1 : 0;
    }
  }
  EXPECT_GT(num_zeros, 1000);
}

TEST(Side, SeesTheLastBit) {
  const Vector3f a(0, 0, 1), b(1e10f, 0, 1), c(0, 1e10f, 1);
  EXPECT_EQ(Side(a, b, c, {3e9f, 2e9f, 1}), 0);
  EXPECT_EQ(Side(a, b, c, {3e9f, 2e9f, std::nextafter(1.f, 2.f)}), -1);
  EXPECT_EQ(Side(a, b, c, {3e9f, 2e9f, std::nextafter(1.f, 0.f)}), 1);
}

// As a determinant does; rounding would break it near to zero.
TEST(Side, ChangesSignWithEachSwap) {
  Random random(2);
  for (int trial = 0; trial < 20000; ++trial) {
    Vector3f p[4];
    for (int k = 0; k < 3; ++k) {
      p[k] = {AnyFloat(&random), AnyFloat(&random), AnyFloat(&random)};
    }
    const auto t = static_cast<float>(random.Unit());
    p[3] = p[0] + t * (p[1] - p[0]) + (1 - t) * (p[2] - p[0]);
    const int side = Side(p[0], p[1], p[2], p[3]);
    EXPECT_EQ(Side(p[1], p[0], p[2], p[3]), -side);
    EXPECT_EQ(Side(p[0], p[2], p[1], p[3]), -side);
    EXPECT_EQ(Side(p[0], p[1], p[3], p[2]), -side);
    EXPECT_EQ(Side(p[3], p[1], p[2], p[0]), -side);
  }
}

TEST(Turn, IsExact) {
  Random random(3);
  for (int trial = 0; trial < 20000; ++trial) {
    const Vector3f a = IntegerPoint(1 << 20, &random);
    const Vector3f b = a + IntegerPoint(3, &random);
    const Vector3f c = a + IntegerPoint(3, &random);
    const IntVector u = ToIntegers(b) - ToIntegers(a);
    const IntVector v = ToIntegers(c) - ToIntegers(a);
    const IntVector cross = u.cross(v);
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(Turn(a, b, c, axis), Sign(cross[axis]));
    }
    EXPECT_EQ(AreCollinear(a, b, c), cross.isZero());
  }
}

TEST(Turn, ChangesSignWithEachSwap) {
  Random random(4);
  for (int trial = 0; trial < 20000; ++trial) {
    Vector3f a(AnyFloat(&random), AnyFloat(&random), AnyFloat(&random));
    Vector3f b(AnyFloat(&random), AnyFloat(&random), AnyFloat(&random));
    const Vector3f c = a + static_cast<float>(random.Unit()) * (b - a);
    for (int axis = 0; axis < 3; ++axis) {
      const int turn = Turn(a, b, c, axis);
      EXPECT_EQ(Turn(b, c, a, axis), turn);
      EXPECT_EQ(Turn(b, a, c, axis), -turn);
      EXPECT_EQ(Turn(a, c, b, axis), -turn);
    }
  }
}

}  // namespace orientation_test
}  // namespace colmap_ext
