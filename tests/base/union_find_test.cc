#include "base/union_find.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/random.h"

namespace colmap_ext {
namespace union_find_test {

TEST(UnionFind, StartsWithEachByItself) {
  UnionFind sets(5);
  for (uint32_t i = 0; i < 5; ++i) {
    EXPECT_EQ(sets.Find(i), i);
  }
}

// Against labels that are all rewritten at each join.
TEST(UnionFind, NamesEachSetByItsLowest) {
  constexpr uint32_t kSize = 200;
  Random random(1);
  UnionFind sets(kSize);
  std::vector<uint32_t> labels(kSize);
  for (uint32_t i = 0; i < kSize; ++i) {
    labels[i] = i;
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

}  // namespace union_find_test
}  // namespace colmap_ext
