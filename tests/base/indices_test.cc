#include "base/indices.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "base/index_limit.h"
#include "base/union_find.h"
#include "tests/random.h"

namespace colmap_ext {
namespace indices_test {

TEST(ExpectIndexable, TakesWhatThirtyTwoBitsCanNumber) {
  for (const uint64_t count : {uint64_t{0}, uint64_t{1}, kMaxIndexed}) {
    EXPECT_EQ(ExpectIndexable(count, "points"), count);
  }
  for (const uint64_t count : {kMaxIndexed + 1, 3 * kMaxIndexed, UINT64_MAX}) {
    EXPECT_THROW(ExpectIndexable(count, "points"), std::invalid_argument);
  }
}

TEST(IndexOf, FindsWhatIsThere) {
  const std::vector<int> values = {2, 3, 7};
  EXPECT_EQ(IndexOf(values, 2), 0u);
  EXPECT_EQ(IndexOf(values, 7), 2u);
  for (const int value : {1, 5, 8}) {
    EXPECT_EQ(IndexOf(values, value), kNone);
  }
}

// Against labels that are all rewritten at each join.
TEST(UnionFind, NamesEachSetByItsLowest) {
  constexpr uint32_t kSize = 200;
  Random random(1);
  UnionFind sets(kSize);
  std::vector<uint32_t> labels(kSize);
  std::iota(labels.begin(), labels.end(), 0);
  for (uint32_t i = 0; i < kSize; ++i) {
    EXPECT_EQ(sets.Find(i), i);
  }
  for (int join = 0; join < 180; ++join) {
    const uint32_t a = random.Below(kSize);
    const uint32_t b = random.Below(kSize);
    sets.Join(a, b);
    const auto [low, high] = std::minmax(labels[a], labels[b]);
    std::replace(labels.begin(), labels.end(), uint32_t{high}, uint32_t{low});
    for (uint32_t i = 0; i < kSize; ++i) {
      ASSERT_EQ(sets.Find(i), labels[i]);
    }
  }
}

}  // namespace indices_test
}  // namespace colmap_ext
