#include "base/index_limit.h"

#include <gtest/gtest.h>

namespace colmap_ext {
namespace index_limit_test {

TEST(ExpectIndexable, TakesWhatThirtyTwoBitsCanNumber) {
  for (const uint64_t count : {uint64_t{0}, uint64_t{1}, kMaxIndexed}) {
    EXPECT_EQ(ExpectIndexable(count, "points"), count);
  }
  for (const uint64_t count : {kMaxIndexed + 1, 3 * kMaxIndexed, UINT64_MAX}) {
    EXPECT_THROW(ExpectIndexable(count, "points"), std::invalid_argument);
  }
}

}  // namespace index_limit_test
}  // namespace colmap_ext
