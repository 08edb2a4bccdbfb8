#include "photometry/direction_sums.h"

#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "tests/peak_memory.h"

namespace colmap_ext {
namespace direction_sums_test {

// Each thread has one.
TEST(DirectionEvaluator, TakesLittleMemoryForEachFacet) {
  constexpr size_t kNumFacets = 32000000;
  const size_t before = PeakMemory();
  const DirectionEvaluator evaluator({}, kNumFacets);
  EXPECT_LT(PeakMemory() - before, kNumFacets / 2);
}

TEST(FacetPlaces, AreThoseInTheList) {
  std::mt19937 random(2);
  FacetPlaces places(1000);
  for (int trial = 0; trial < 10; ++trial) {
    std::vector<uint32_t> facets;
    for (uint32_t i = 0; i < 1000; ++i) {
      if (random() % 10 < static_cast<uint32_t>(trial)) {
        facets.push_back(i);
      }
    }
    places.Set(facets);
    for (uint32_t i = 0, k = 0; i < 1000; ++i) {
      const bool is_there = k < facets.size() && facets[k] == i;
      ASSERT_EQ(places.Has(i), is_there);
      if (is_there) {
        ASSERT_EQ(places[i], k++);
      }
    }
    places.Clear(facets);
  }
}

}  // namespace direction_sums_test
}  // namespace colmap_ext
