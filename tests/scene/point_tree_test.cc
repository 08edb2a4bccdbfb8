#include "scene/point_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/random_vectors.h"

namespace colmap_ext {
namespace point_tree_test {

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
  std::sort(all.begin(), all.end());
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

TEST(PointTreeTest, FindsNothingFromAPlaceThatIsNotFinite) {
  const std::vector<Eigen::Vector3f> points(20, Eigen::Vector3f::Zero());
  const PointTree tree(points);
  for (const float x : {kAnywhere, std::nanf("")}) {
    EXPECT_TRUE(tree.Nearest({x, 0, 0}, 3, kAnywhere).empty());
  }
}

TEST(PointTreeTest, MayBeEmpty) {
  EXPECT_TRUE(
      PointTree({}).Nearest(Eigen::Vector3f::Zero(), 3, kAnywhere).empty());
}

}  // namespace point_tree_test
}  // namespace colmap_ext
