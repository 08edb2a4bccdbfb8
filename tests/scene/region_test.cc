#include "scene/region.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "scene/point_tree.h"
#include "scene/view.h"
#include "tests/random_vectors.h"

namespace colmap_ext::region_test {

Region RandomRegion(Random* random) {
  const Eigen::Quaterniond rotation =
      Eigen::Quaterniond(random->Unit(), random->Unit(), random->Unit(),
                         random->Unit() + 0.1)
          .normalized();
  return {rotation.toRotationMatrix(), RandomVector(random, 1),
          Eigen::Vector3d(0.2, 0.2, 0.2) + RandomVector(random, 1).cwiseAbs()};
}

TEST(RegionTest, HoldsWhatLiesBetweenItsCornersOrEverything) {
  const Region region = RegionBetween({-1, 2, 3}, {1, 4, 9});
  EXPECT_TRUE(region.Contains(Eigen::Vector3d(-1, 2, 3)));
  EXPECT_TRUE(region.Contains(Eigen::Vector3d(0.5, 3.9, 8.9)));
  EXPECT_FALSE(region.Contains(Eigen::Vector3d(1.01, 3, 5)));
  EXPECT_FALSE(region.Contains(Eigen::Vector3d(0, 1.99, 5)));
  EXPECT_TRUE(Grow(region, 0.1).Contains(Eigen::Vector3d(1.01, 3, 5)));
  EXPECT_TRUE(Region().Contains(Eigen::Vector3d(1e30, -1e30, 0)));
}

// Against points along the segment.
TEST(RegionTest, FindsThePartOfASegmentInsideOrAlongASide) {
  Random random(1);
  for (int i = 0; i < 200; ++i) {
    const Region region = RandomRegion(&random);
    const Eigen::Vector3d start = RandomVector(&random, 3);
    const Eigen::Vector3d end = RandomVector(&random, 3);
    const SegmentPart part = PartInside(region, start, end);
    for (int k = 0; k <= 100; ++k) {
      const double share = k / 100.0;
      const bool is_inside =
          region.Contains(Eigen::Vector3d(start + share * (end - start)));
      const bool is_in_part = share >= part.first && share <= part.second;
      EXPECT_EQ(is_inside, is_in_part) << i << " " << share;
    }
  }
  const Region region = RegionBetween({0, 0, 0}, {1, 1, 1});
  EXPECT_FALSE(PartInside(region, {-1, 0.5, 0.5}, {2, 0.5, 0.5}).IsEmpty());
  EXPECT_TRUE(PartInside(region, {-1, 1.5, 0.5}, {2, 1.5, 0.5}).IsEmpty());
}

// Views around the origin that look at it.
std::vector<View> ViewsAround() {
  std::vector<View> views;
  for (int i = 0; i < 8; ++i) {
    const double angle = i * 0.785;
    views.push_back(LookAtView({5 * std::cos(angle), 5 * std::sin(angle), 1},
                               {0, 0, 0}, {0, 0, 1}, 640, 480, 800));
  }
  return views;
}

// An object of sizes 2, 1 and 0.5, and walls far behind it.
std::vector<Eigen::Vector3f> ObjectAndWalls(Random* random) {
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3d unit = RandomVector(random, 1);
    points.emplace_back(
        unit.cwiseProduct(Eigen::Vector3d(1, 0.5, 0.25)).cast<float>());
    if (i % 5 == 0) {
      points.emplace_back(30 * unit.normalized().cast<float>());
    }
  }
  return points;
}

TEST(FocusRegionTest, IsTheBoxOfWhatMostViewsLookAtOrNothing) {
  Random random(2);
  const std::optional<Region> region =
      FocusRegion(ViewsAround(), ObjectAndWalls(&random));
  ASSERT_TRUE(region);
  EXPECT_NEAR(region->half_sizes.x(), 1.2, 0.05);
  EXPECT_NEAR(region->half_sizes.y(), 0.6, 0.05);
  EXPECT_NEAR(region->half_sizes.z(), 0.3, 0.05);
  EXPECT_LT(region->center.norm(), 0.1);
  EXPECT_NEAR(region->region_from_world.determinant(), 1, 1e-12);
  EXPECT_FALSE(FocusRegion(ViewsAround(), {}));
  EXPECT_FALSE(FocusRegion({}, {100, Eigen::Vector3f::Ones()}));
  EXPECT_FALSE(FocusRegion(ViewsAround(), {100, Eigen::Vector3f::Zero()}));
}

TEST(FocusRegionTest, TurnsWithTheScene) {
  Random random(3);
  std::vector<View> views = ViewsAround();
  std::vector<Eigen::Vector3f> points = ObjectAndWalls(&random);
  const Region region = *FocusRegion(views, points);
  const Eigen::Matrix3d turn =
      Eigen::Quaterniond(0.5, 0.1, -0.7, 0.2).normalized().toRotationMatrix();
  for (View& view : views) {
    view.cam_from_world_rotation =
        view.cam_from_world_rotation * turn.transpose();
  }
  for (Eigen::Vector3f& point : points) {
    point = turn.cast<float>() * point;
  }
  const Region turned = *FocusRegion(views, points);
  EXPECT_TRUE(turned.half_sizes.isApprox(region.half_sizes, 1e-3));
  EXPECT_TRUE((turned.center - turn * region.center).norm() < 1e-3);
}

constexpr float kAnywhere = std::numeric_limits<float>::infinity();

Eigen::Vector3f RandomPoint(Random* random) {
  return RandomVector(random).cast<float>();
}

std::vector<uint32_t> NearestOfAll(const std::vector<Eigen::Vector3f>& points,
                                   const Eigen::Vector3f& place, size_t count,
                                   float max_distance) {
  std::vector<std::pair<float, uint32_t>> all;
  for (uint32_t i = 0; i < points.size(); ++i) {
    const float distance_squared = (points[i] - place).squaredNorm();
    if (distance_squared <= max_distance * max_distance) {
      all.emplace_back(distance_squared, i);
    }
  }
  std::ranges::sort(all);
  std::vector<uint32_t> nearest;
  for (size_t i = 0; i < std::min(count, all.size()); ++i) {
    nearest.push_back(all[i].second);
  }
  return nearest;
}

TEST(PointTreeTest, FindsWhatIsNearest) {
  Random random(1);
  for (const size_t num_points : {1, 2, 3, 10, 500, 40000}) {
    std::vector<Eigen::Vector3f> points(num_points);
    for (Eigen::Vector3f& point : points) {
      point = RandomPoint(&random);
    }
    const PointTree tree(points);
    for (int i = 0; i < 20; ++i) {
      const Eigen::Vector3f place = RandomPoint(&random);
      for (const size_t count : {0, 1, 4, 30}) {
        for (const float max_distance : {0.04f, 0.6f, kAnywhere}) {
          EXPECT_EQ(tree.Nearest(place, count, max_distance),
                    NearestOfAll(points, place, count, max_distance));
        }
      }
    }
  }
}

TEST(PointTreeTest, FindsWhatIsWithinADistance) {
  Random random(4);
  std::vector<Eigen::Vector3f> points(3000);
  for (Eigen::Vector3f& point : points) {
    point = RandomPoint(&random);
  }
  const PointTree tree(points);
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector3f place = RandomPoint(&random);
    for (const float distance : {0.0f, 0.1f, 0.5f, 9.0f}) {
      std::vector<uint32_t> found = tree.Within(place, distance);
      std::ranges::sort(found);
      std::vector<uint32_t> expected;
      for (uint32_t k = 0; k < points.size(); ++k) {
        if ((points[k] - place).norm() < distance) {
          expected.push_back(k);
        }
      }
      EXPECT_EQ(found, expected);
    }
  }
  EXPECT_TRUE(PointTree({}).Within(Eigen::Vector3f::Zero(), 1).empty());
}

TEST(PointTreeTest, TakesTheLowerIndexOfPointsAsFar) {
  Random random(2);
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 300; ++i) {
    points.emplace_back(random.Integer(0, 2), random.Integer(0, 2), 0);
  }
  const PointTree tree(points);
  for (const Eigen::Vector3f& place : points) {
    EXPECT_EQ(tree.Nearest(place, 7, kAnywhere),
              NearestOfAll(points, place, 7, kAnywhere));
  }
}

TEST(PointTreeTest, DoesNotDependOnScaleOrAccumulation) {
  Random random(3);
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 2000; ++i) {  // ever denser towards the origin
    const float scale = std::exp2(static_cast<float>(random.Integer(-30, 10)));
    points.emplace_back(scale * RandomPoint(&random));
    if (i % 3 == 0) {
      points.push_back(points[random.Below(points.size())]);  // twice
    }
  }
  const PointTree tree(points);
  for (size_t i = 0; i < points.size(); i += 7) {
    for (const float max_distance : {0.0f, 1e-6f, kAnywhere}) {
      for (const float away : {1.0f, 1.01f}) {
        const Eigen::Vector3f place = away * points[i];
        EXPECT_EQ(tree.Nearest(place, 9, max_distance),
                  NearestOfAll(points, place, 9, max_distance));
      }
    }
  }
}

TEST(PointTreeTest, FindsNothingFromAPlaceThatIsNotFiniteOrInNoPoints) {
  const std::vector<Eigen::Vector3f> points(20, Eigen::Vector3f::Zero());
  const PointTree tree(points);
  for (const float x : {kAnywhere, std::nanf("")}) {
    EXPECT_TRUE(tree.Nearest({x, 0, 0}, 3, kAnywhere).empty());
  }
  EXPECT_TRUE(
      PointTree({}).Nearest(Eigen::Vector3f::Zero(), 3, kAnywhere).empty());
}

}  // namespace colmap_ext::region_test
