#include "meshing/wall_layers.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Core>

#include "meshing/manifold_meshing.h"
#include "scene/view.h"
#include "tests/random.h"

namespace colmap_ext::wall_layers_test {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double kDistance = 10;  // of the cameras from the wall
constexpr double kPixel = 0.01;   // on the wall

// Eight cameras side by side that look at a wall around the origin. Even ones
// are of one group of images, odd ones of the other.
// \param are_odd_behind  those of the other group are on the other side
std::vector<View> MakeViews(bool are_odd_behind = false) {
  std::vector<View> views;
  for (int i = 0; i < 8; ++i) {
    const double z = are_odd_behind && i % 2 == 1 ? kDistance : -kDistance;
    views.push_back(LookAtView({i - 3.5, 0.3 * (i % 3), z}, Vector3d::Zero(),
                               -Vector3d::UnitY(), 1000, 1000,
                               kDistance / kPixel));
  }
  return views;
}

// Of mean 0 and deviation 1.
double Gaussian(Random* random) {
  return std::sqrt(-2 * std::log(1 - random->Unit())) *
         std::cos(2 * M_PI * random->Unit());
}

constexpr int kRows = 160;  // of points, a pixel apart

// A wall of points, each as deep as a function says, with noise, and seen by
// the views of its group of images that the wall does not hide it from.
// \param depth  px behind the wall at (x, y) px, for a group of images
// \param num_images  that see a point, of a group
WeightedCloud MakeWall(const std::function<double(double, double, int)>& depth,
                       const std::vector<int>& num_images, double noise) {
  Random random(5);
  const std::vector<View> views = MakeViews();
  WeightedCloud wall;
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kRows; ++column) {
      const auto group = static_cast<int>(random.Chance(0.5));
      const double x = column - kRows / 2 + random.Unit() - 0.5;
      const double y = row - kRows / 2 + random.Unit() - 0.5;
      const double z = depth(x, y, group) + noise * Gaussian(&random);
      wall.cloud.positions.push_back(
          (kPixel * Vector3d(x, y, z)).cast<float>());
      std::vector<uint32_t> seen_by;
      for (int i = 0; i < num_images[group]; ++i) {
        const auto view = static_cast<uint32_t>(2 * i + group);
        const Vector3d direction = views[view].Center() / kDistance;
        bool sees = true;
        for (double height = 1; height < z; ++height) {
          const Vector3d at = Vector3d(x, y, z) + height * direction;
          sees = sees && depth(at.x(), at.y(), group) > at.z() - 1;
        }
        if (sees) {
          seen_by.push_back(view);
        }
      }
      wall.cloud.views.AddRow(seen_by);
      wall.weights.push_back(1);
    }
  }
  wall.num_points = wall.cloud.size();
  return wall;
}

// The share of a cloud's points behind the middle of two layers.
double ShareBehind(const WeightedCloud& wall, double middle) {
  const auto count = std::ranges::count_if(
      wall.cloud.positions,
      [&](const Vector3f& position) { return position.z() > kPixel * middle; });
  return static_cast<double>(count) /
         static_cast<double>(wall.cloud.positions.size());
}

TEST(DropWeakerLayers, KeepsTheLayerThatMoreImagesSee) {
  const auto layers = [](double, double, int group) { return 9.0 * group; };
  for (const bool is_front_stronger : {false, true}) {
    WeightedCloud wall = MakeWall(
        layers, is_front_stronger ? std::vector{4, 3} : std::vector{3, 4}, 0.7);
    const size_t num_points = wall.num_points;
    const size_t num_dropped = DropWeakerLayers(MakeViews(), &wall);
    EXPECT_EQ(wall.num_points, num_points - num_dropped);
    EXPECT_EQ(wall.cloud.size(), wall.num_points);
    EXPECT_EQ(wall.weights.size(), wall.num_points);
    EXPECT_NEAR(static_cast<double>(num_dropped),
                0.5 * static_cast<double>(num_points),
                0.08 * static_cast<double>(num_points));
    const double right =
        is_front_stronger ? 1 - ShareBehind(wall, 4.5) : ShareBehind(wall, 4.5);
    EXPECT_GT(right, 0.95) << is_front_stronger;
  }
}

// Images that are mostly in the majority are trusted where they are not.
TEST(DropWeakerLayers, KeepsTheSameLayerOfAWall) {
  const auto layers = [](double, double, int group) { return 9.0 * group; };
  WeightedCloud wall = MakeWall(layers, {4, 2}, 0.7);
  const WeightedCloud other = MakeWall(layers, {3, 4}, 0.7);
  for (size_t i = 0; i < other.cloud.size(); ++i) {
    // A strip along one side.
    if (other.cloud.positions[i].x() > 40 * kPixel) {
      wall.cloud.positions.push_back(other.cloud.positions[i]);
      wall.cloud.views.AddRow(other.cloud.views[i]);
      wall.weights.push_back(1);
    }
  }
  wall.num_points = wall.cloud.size();
  DropWeakerLayers(MakeViews(), &wall);
  EXPECT_LT(ShareBehind(wall, 4.5), 0.05);
}

TEST(DropWeakerLayers, KeepsEndsOfRays) {
  WeightedCloud wall = MakeWall(
      [](double, double, int group) { return 9.0 * group; }, {4, 3}, 0.7);
  const RayEnds ends{{{0, 0, 0.09f}, 1, 0.5f}, {{0, 0, 0.08f}, 3, 0.25f}};
  AppendEnds(ends, &wall);
  ASSERT_GT(DropWeakerLayers(MakeViews(), &wall), 0u);
  ASSERT_EQ(wall.cloud.size(), wall.num_points + ends.size());
  for (size_t i = 0; i < ends.size(); ++i) {
    const size_t at = wall.num_points + i;
    EXPECT_EQ(wall.cloud.positions[at], ends[i].position);
    EXPECT_EQ(wall.cloud.views[at].front(), ends[i].view);
    EXPECT_EQ(wall.weights[at], ends[i].weight);
  }
}

// Shares of the points that are dropped where nothing is there twice.
double DroppedShare(const std::function<double(double, double, int)>& depth,
                    double noise) {
  WeightedCloud wall = MakeWall(depth, {4, 4}, noise);
  const auto num_points = static_cast<double>(wall.num_points);
  return static_cast<double>(DropWeakerLayers(MakeViews(), &wall)) / num_points;
}

TEST(DropWeakerLayers, KeepsWhatIsThereOnce) {
  const auto flat = [](double, double, int) { return 0.0; };
  EXPECT_EQ(DroppedShare(flat, 0.7), 0);
  EXPECT_LT(DroppedShare(flat, 1.5), 0.001);
  EXPECT_LT(DroppedShare(flat, 5), 0.01);
  const auto windows = [](double x, double y, int) {
    return std::sin(x / 15) * std::sin(y / 15) > 0.3 ? 9.0 : 0.0;
  };
  EXPECT_LT(DroppedShare(windows, 0.7), 0.02);
  Random random(7);
  const auto crown = [&](double, double, int) {
    return 80 * random.Unit() - 40;
  };
  EXPECT_LT(DroppedShare(crown, 0), 0.001);
}

TEST(DropWeakerLayers, KeepsBothSidesOfThinWalls) {
  WeightedCloud wall = MakeWall(
      [](double, double, int group) { return 9.0 * group; }, {4, 3}, 0.7);
  EXPECT_EQ(DropWeakerLayers(MakeViews(true), &wall), 0u);
}

TEST(DropWeakerLayers, TakesFewPointsAndNoPoints) {
  WeightedCloud none;
  EXPECT_EQ(DropWeakerLayers(MakeViews(), &none), 0u);
  WeightedCloud few;
  for (int i = 0; i < 30; ++i) {
    few.cloud.positions.emplace_back(0, 0, 0);
    few.cloud.views.AddRow(i % 2 == 0 ? std::vector<uint32_t>{}
                                      : std::vector<uint32_t>{0, 1});
    few.weights.push_back(1);
  }
  few.num_points = few.cloud.size();
  EXPECT_EQ(DropWeakerLayers(MakeViews(), &few), 0u);
}

TEST(DropWeakerLayers, IsAnOptionOfTheMesher) {
  WeightedCloud wall = MakeWall(
      [](double, double, int group) { return 9.0 * group; }, {4, 3}, 0.7);
  ManifoldMeshingOptions options;
  const auto num_weaker = [&] {
    return MeshManifold(options, wall.cloud, MakeViews())
        .report.num_weaker_points;
  };
  EXPECT_GT(num_weaker(), 0u);
  options.drop_weaker_layers = false;
  EXPECT_EQ(num_weaker(), 0u);
}

}  // namespace
}  // namespace colmap_ext::wall_layers_test
