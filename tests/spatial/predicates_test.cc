#include "spatial/predicates.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "tests/delaunay/exact.h"
#include "tests/random.h"

namespace colmap_ext::predicates_test {

using Eigen::Vector3d;
using Eigen::Vector3f;

// Integer coordinates in -range ... range.
Vector3d RandomPoint(int range, Random* random) {
  Vector3d point;
  for (int k = 0; k < 3; ++k) {
    point[k] = random->Integer(-range, range);
  }
  return point;
}

template <size_t N>
std::array<Vector3d, N> RandomPoints(int range, Random* random) {
  std::array<Vector3d, N> points;
  std::ranges::generate(points, [&] { return RandomPoint(range, random); });
  return points;
}

// Of any magnitude.
Vector3f AnyPoint(Random* random) {
  Vector3f point;
  for (int k = 0; k < 3; ++k) {
    point[k] = std::ldexp(static_cast<float>(random->Unit() - 0.5),
                          random->Integer(-30, 30));
  }
  return point;
}

IntVector ToInt(const Vector3d& point) { return point.cast<int64_t>(); }

TEST(Orientation, IsExact) {
  Random random(1);
  for (const int range : {1, 3, 1 << 20}) {
    for (int trial = 0; trial < 2000; ++trial) {
      auto p = RandomPoints<4>(range, &random);
      if (random.Chance(0.5)) {
        p[3] = p[1] + p[2] - p[0];  // coplanar
        p[3].z() += random.Integer(-1, 1);
      }
      const int expected =
          ExactOrientation(ToInt(p[0]), ToInt(p[1]), ToInt(p[2]), ToInt(p[3]));
      ASSERT_EQ(Orientation(p[0], p[1], p[2], p[3]), expected);
      ASSERT_EQ(Orientation(Vector3f(p[0].cast<float>()), p[1].cast<float>(),
                            p[2].cast<float>(), p[3].cast<float>()),
                expected);
    }
  }
}

TEST(Orientation, SeesTheLastBit) {
  const Vector3f a(0, 0, 1), b(1e10f, 0, 1), c(0, 1e10f, 1);
  EXPECT_EQ(Orientation(a, b, c, {3e9f, 2e9f, 1}), 0);
  EXPECT_EQ(Orientation(a, b, c, {3e9f, 2e9f, std::nextafter(1.f, 2.f)}), 1);
  EXPECT_EQ(Orientation(a, b, c, {3e9f, 2e9f, std::nextafter(1.f, 0.f)}), -1);
}

// As a determinant does; rounding would break it near to zero.
TEST(Orientation, ChangesSignWithEachSwap) {
  Random random(4);
  for (int trial = 0; trial < 20000; ++trial) {
    const Vector3f a = AnyPoint(&random);
    const Vector3f b = AnyPoint(&random);
    const Vector3f c = AnyPoint(&random);
    const auto t = static_cast<float>(random.Unit());
    const Vector3f d = a + t * (b - a) + (1 - t) * (c - a);
    const int side = Orientation(a, b, c, d);
    EXPECT_EQ(Orientation(b, a, c, d), -side);
    EXPECT_EQ(Orientation(a, c, b, d), -side);
    EXPECT_EQ(Orientation(a, b, d, c), -side);
    EXPECT_EQ(Orientation(d, b, c, a), -side);
  }
}

TEST(AreCollinear, IsExact) {
  Random random(5);
  for (int trial = 0; trial < 20000; ++trial) {
    const Vector3d a = RandomPoint(1 << 20, &random);
    const Vector3d b = a + RandomPoint(3, &random);
    const Vector3d c = a + RandomPoint(3, &random);
    EXPECT_EQ(AreCollinear(a.cast<float>(), b.cast<float>(), c.cast<float>()),
              ToInt(b - a).cross(ToInt(c - a)).isZero());
  }
}

TEST(CenterFrom, IsExactForFlatCells) {
  // In the plane z = 0 but for the last point, just above the circle's centre.
  const Vector3d center = CenterFrom({1, 0, 0}, {-1, 0, 0}, {0, 1, 0},
                                     {0, 0, std::ldexp(1.f, -60)});
  EXPECT_EQ(center.x(), -1);
  EXPECT_EQ(center.y(), 0);
  EXPECT_DOUBLE_EQ(center.z(), -std::ldexp(1., 59));  // (h^2 - 1) / 2 h
}

// With a number for the infinitesimal: e = 1 / 1024 and all multiplied by
// 1024^3, which is small enough for coordinates up to 3.
int SideWithSmallStep(const Vector3d& origin, const Vector3d& target,
                      const Vector3d& u, const Vector3d& v) {
  constexpr int64_t kScale = 1024;
  const IntVector step(kScale * kScale, kScale, 1);
  const IntVector direction =
      kScale * kScale * kScale * ToInt(target - origin) + step;
  return Sign(Determinant(direction, ToInt(u - origin), ToInt(v - origin)));
}

// Far off and nearly along the plane, where rounding leaves nothing of it.
TEST(CrossingOfPlane, IsExactButForTheLastBit) {
  Random random(3);
  for (const int range : {3, 1 << 18}) {
    for (int trial = 0; trial < 500; ++trial) {
      auto [a, b, c, origin, target] = RandomPoints<5>(range, &random);
      target += random.Integer(0, 1 << 20) * (b + c - 2 * a);
      const auto side = [&](const Vector3d& place) {
        return Determinant(ToInt(b - a), ToInt(c - a), ToInt(place - a));
      };
      const Int128 way = side(origin) - side(target);
      const double expected = way != 0 ? static_cast<double>(side(origin)) /
                                             static_cast<double>(way)
                                       : 0;
      ASSERT_NEAR(CrossingOfPlane(origin, target, a, b, c), expected,
                  1e-15 * std::abs(expected));
    }
  }
}

TEST(RaySideExact, IsThatOfALineMovedALittle) {
  Random random(2);
  size_t num_degenerate = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    const auto [origin, target, u, v] = RandomPoints<4>(2, &random);
    const int side = RaySideExact(origin, target, u, v);
    ASSERT_EQ(side, SideWithSmallStep(origin, target, u, v));
    ASSERT_EQ(side, -RaySideExact(origin, target, v, u));
    const bool is_collinear =
        ToInt(u - origin).cross(ToInt(v - origin)).isZero();
    ASSERT_EQ(side == 0, is_collinear);
    num_degenerate += !is_collinear && Orientation(origin, target, u, v) == 0;
  }
  EXPECT_GT(num_degenerate, 1000u);
}

}  // namespace colmap_ext::predicates_test
