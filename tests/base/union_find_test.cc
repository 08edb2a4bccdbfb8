#include "base/union_find.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include "base/indices.h"
#include "tests/random.h"

namespace colmap_ext::union_find_test {

// Against labels that are all rewritten at each join.
TEST(UnionFind, NamesEachSetByItsLowest) {
  constexpr uint32_t kSize = 200;
  Random random(1);
  UnionFind sets(kSize);
  std::vector<uint32_t> labels = Iota(kSize);
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

TEST(UnionFind, IsTheSameInParallel) {
  constexpr uint32_t kSize = 20000;
  Random random(3);
  for (const size_t num_pairs : {size_t{kSize / 3}, size_t{2 * kSize}}) {
    std::vector<std::array<uint32_t, 2>> pairs;
    for (size_t i = 0; i < num_pairs; ++i) {
      pairs.push_back({random.Below(kSize), random.Below(kSize)});
    }
    UnionFind one_by_one(kSize);
    size_t num_joined = 0;
    for (const auto& [a, b] : pairs) {
      num_joined += one_by_one.Join(a, b);
    }
    for (int repeat = 0; repeat < 5; ++repeat) {
      UnionFind in_parallel(kSize);
      std::atomic<size_t> count = 0;
      tbb::parallel_for(size_t{0}, num_pairs, [&](size_t i) {
        count += in_parallel.Join(pairs[i][0], pairs[i][1]);
      });
      EXPECT_EQ(count, num_joined);
      size_t num_sets = 0;
      for (uint32_t i = 0; i < kSize; ++i) {
        ASSERT_EQ(in_parallel.Find(i), one_by_one.Find(i));
        ASSERT_LE(in_parallel.Find(i), i);
        num_sets += in_parallel.Find(i) == i;
      }
      EXPECT_EQ(num_sets, kSize - num_joined);
    }
  }
}

}  // namespace colmap_ext::union_find_test
