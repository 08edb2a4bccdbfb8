#include "tiles/split_tree.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "tests/delaunay/random_complex.h"

namespace colmap_ext {
namespace split_tree_test {

TEST(SplitTree, PartsAreOfAboutEqualWeight) {
  Random random(1);
  const std::vector<Eigen::Vector3f> points =
      RandomPoints(20000, 100000, &random);
  std::vector<float> weights;
  for (const Eigen::Vector3f& point : points) {
    weights.push_back(point.x() > 0 ? 3 : 1);
  }
  for (const size_t num_parts : {1, 2, 3, 7, 16}) {
    const SplitTree tree(points, weights, num_parts);
    std::vector<double> sums(num_parts, 0);
    double total = 0;
    for (size_t i = 0; i < points.size(); ++i) {
      ASSERT_LT(tree.PartOf(points[i]), num_parts);
      sums[tree.PartOf(points[i])] += weights[i];
      total += weights[i];
    }
    const double mean = total / static_cast<double>(num_parts);
    EXPECT_GT(std::ranges::min(sums), 0.98 * mean);
    EXPECT_LT(std::ranges::max(sums), 1.02 * mean);
  }
}

TEST(SplitTree, KnowsPlacesThatNoPointIsAt) {
  Random random(2);
  const std::vector<Eigen::Vector3f> points = RandomPoints(100, 10, &random);
  const SplitTree tree(points, std::vector<float>(points.size(), 1), 8);
  EXPECT_LT(tree.PartOf({1e6f, -1e6f, 0}), 8u);
}

}  // namespace split_tree_test
}  // namespace colmap_ext
