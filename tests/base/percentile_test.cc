#include "base/percentile.h"

#include <gtest/gtest.h>

#include "tests/random.h"

namespace colmap_ext {
namespace {

TEST(Percentile, IsAnElementOfThatRank) {
  Random random(1);
  for (const size_t size : {1, 2, 7, 100, 1001}) {
    std::vector<float> values;
    for (size_t i = 0; i < size; ++i) {
      values.push_back(static_cast<float>(random.Below(50)));
    }
    std::vector<float> sorted = values;
    std::sort(sorted.begin(), sorted.end());
    for (const double percent : {0.0, 12.5, 50.0, 95.0, 100.0}) {
      const double rank = percent / 100 * static_cast<double>(size - 1);
      std::vector<float> reordered = values;
      EXPECT_EQ(Percentile(percent, &reordered),
                sorted[static_cast<size_t>(std::lround(rank))]);
      std::sort(reordered.begin(), reordered.end());
      EXPECT_EQ(reordered, sorted);
    }
  }
}

TEST(Percentile, OfZeroAndHundredAreTheExtremes) {
  std::vector<float> values = {3, -1, 7, 2};
  EXPECT_EQ(Percentile(0, &values), -1);
  EXPECT_EQ(Percentile(100, &values), 7);
}

}  // namespace
}  // namespace colmap_ext
