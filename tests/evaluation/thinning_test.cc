#include "evaluation/thinning.h"

#include <array>
#include <cmath>
#include <set>
#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/random.h"

namespace colmap_ext {
namespace {

using Points = std::vector<Eigen::Vector3f>;

std::array<float, 3> Cube(const Eigen::Vector3f& point, float spacing) {
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

TEST(Thin, KeepsTheMiddlemostPointOfEachCubeInAnyOrderOfThem) {
  constexpr float kSpacing = 0.5f;
  Random random(1);
  Points points = RandomPoints(&random);
  Points thin = points;
  Thin(kSpacing, &thin);
  std::set<std::array<float, 3>> cubes, thin_cubes;
  for (const Eigen::Vector3f& point : points) {
    cubes.insert(Cube(point, kSpacing));
  }
  for (const Eigen::Vector3f& point : thin) {
    EXPECT_TRUE(thin_cubes.insert(Cube(point, kSpacing)).second);
  }
  EXPECT_EQ(thin_cubes, cubes);
  for (int i = 0; i < 5; ++i) {
    random.Shuffle(&points);
    Points again = points;
    Thin(kSpacing, &again);
    EXPECT_EQ(again, thin);
    Thin(kSpacing, &again);
    EXPECT_EQ(again, thin);
  }
  Points cube = {{0.1f, 0.1f, 0.1f}, {0.2f, 0.2f, 0.3f}, {0.4f, 0, 0}};
  Thin(kSpacing, &cube);
  EXPECT_EQ(cube, (Points{{0.2f, 0.2f, 0.3f}}));
}

TEST(Thin, RefusesAGridThatIsTooFine) {
  Points points = {{1e10f, 0, 0}};
  EXPECT_THROW(Thin(0.1, &points), std::invalid_argument);
  points.clear();
  Thin(0.1, &points);
  EXPECT_TRUE(points.empty());
}

}  // namespace
}  // namespace colmap_ext
