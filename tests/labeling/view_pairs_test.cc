#include <algorithm>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "labeling/facet_labels.h"

namespace colmap_ext {
namespace view_pairs_test {

PointCloud CloudSeenBy(const std::vector<std::vector<uint32_t>>& views) {
  PointCloud cloud;
  for (const std::vector<uint32_t>& row : views) {
    cloud.positions.emplace_back(0, 0, 0);
    cloud.views.values.insert(cloud.views.values.end(), row.begin(), row.end());
    cloud.views.EndRow();
  }
  return cloud;
}

TEST(SelectViewPairs, TakesThePartnersWithTheMostPoints) {
  const PointCloud cloud =
      CloudSeenBy({{0, 1}, {0, 1}, {0, 2}, {1, 2}, {2, 3}, {0, 1, 2}});
  EXPECT_EQ(SelectViewPairs(cloud, 4, 1),
            (std::vector<ViewPair>{{0, 1}, {0, 2}, {2, 3}}));
  EXPECT_EQ(SelectViewPairs(cloud, 4, 3),
            (std::vector<ViewPair>{{0, 1}, {0, 2}, {1, 2}, {2, 3}}));
}

TEST(SelectViewPairs, ResolvesTiesToTheLowerView) {
  EXPECT_EQ(SelectViewPairs(CloudSeenBy({{0, 1, 2, 3}}), 4, 1),
            (std::vector<ViewPair>{{0, 1}, {0, 2}, {0, 3}}));
}

TEST(SelectViewPairs, LeavesViewsWithoutCommonPointsAlone) {
  EXPECT_TRUE(SelectViewPairs(CloudSeenBy({{0}, {1}, {}}), 3, 2).empty());
  EXPECT_TRUE(SelectViewPairs({}, 0, 2).empty());
}

TEST(SelectViewPairs, AgreesWithCountingAllPairs) {
  constexpr uint32_t kNumViews = 12;
  std::mt19937 random(5);
  std::vector<std::vector<uint32_t>> rows(400);
  std::vector<std::vector<int>> counts(kNumViews,
                                       std::vector<int>(kNumViews, 0));
  for (std::vector<uint32_t>& row : rows) {
    for (uint32_t view = 0; view < kNumViews; ++view) {
      if (random() % 4 == 0) {
        row.push_back(view);
      }
    }
    for (const uint32_t a : row) {
      for (const uint32_t b : row) {
        counts[a][b] += a == b ? 0 : 1;
      }
    }
  }
  const std::vector<ViewPair> pairs =
      SelectViewPairs(CloudSeenBy(rows), kNumViews, 3);
  // Whoever is among the three best of one of the two, and nobody else.
  for (uint32_t a = 0; a < kNumViews; ++a) {
    for (uint32_t b = a + 1; b < kNumViews; ++b) {
      const auto is_partner = [&](uint32_t view, uint32_t other) {
        int num_better = 0;
        for (uint32_t k = 0; k < kNumViews; ++k) {
          num_better += counts[view][k] > counts[view][other] ||
                                (counts[view][k] == counts[view][other] &&
                                 k < other && k != view)
                            ? 1
                            : 0;
        }
        return num_better < 3;
      };
      EXPECT_EQ(
          std::find(pairs.begin(), pairs.end(), ViewPair{a, b}) != pairs.end(),
          is_partner(a, b) || is_partner(b, a));
    }
  }
}

}  // namespace view_pairs_test
}  // namespace colmap_ext
