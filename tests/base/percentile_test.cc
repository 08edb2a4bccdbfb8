#include "base/percentile.h"

#include <gtest/gtest.h>

#include "tests/random.h"

namespace colmap_ext {
namespace percentile_test {

template <typename T>
class PercentileTest : public testing::Test {
 protected:
  // Calls check(percent, unsorted, sorted) for many percentages and values,
  // equal ones among them.
  template <typename Check>
  static void ForMany(const Check& check) {
    Random random(1);
    for (const size_t size : {1, 2, 3, 7, 100, 1001}) {
      std::vector<T> values;
      for (size_t i = 0; i < size; ++i) {
        values.push_back(static_cast<T>(random.Below(50)) / 3);
      }
      std::vector<T> sorted = values;
      std::sort(sorted.begin(), sorted.end());
      for (const double percent : {0.0, 12.5, 50.0, 90.0, 95.0, 100.0}) {
        check(percent, values, sorted);
      }
    }
  }

  static void ExpectSameValues(std::vector<T> reordered,
                               const std::vector<T>& sorted) {
    std::sort(reordered.begin(), reordered.end());
    EXPECT_EQ(reordered, sorted);
  }
};

using Types = testing::Types<float, double>;
TYPED_TEST_SUITE(PercentileTest, Types, );

TYPED_TEST(PercentileTest, IsAnElementOfThatRank) {
  this->ForMany([this](double percent, std::vector<TypeParam> values,
                       const std::vector<TypeParam>& sorted) {
    const double rank = percent / 100 * static_cast<double>(sorted.size() - 1);
    EXPECT_EQ(Percentile(percent, &values),
              sorted[static_cast<size_t>(std::lround(rank))]);
    this->ExpectSameValues(values, sorted);
  });
}

TYPED_TEST(PercentileTest, InterpolatesBetweenElements) {
  this->ForMany([this](double percent, std::vector<TypeParam> values,
                       const std::vector<TypeParam>& sorted) {
    const double rank = percent / 100 * static_cast<double>(sorted.size() - 1);
    const auto index = static_cast<size_t>(rank);
    const double share = rank - static_cast<double>(index);
    const double next = sorted[std::min(index + 1, sorted.size() - 1)];
    EXPECT_NEAR(InterpolatedPercentile(percent, &values),
                (1 - share) * sorted[index] + share * next, 1e-5);
    this->ExpectSameValues(values, sorted);
  });
}

TYPED_TEST(PercentileTest, OfZeroAndHundredAreTheExtremes) {
  std::vector<TypeParam> values = {3, -1, 7, 2};
  EXPECT_EQ(Percentile(0, &values), -1);
  EXPECT_EQ(Percentile(100, &values), 7);
  EXPECT_EQ(InterpolatedPercentile(0, &values), -1);
  EXPECT_EQ(InterpolatedPercentile(100, &values), 7);
}

TYPED_TEST(PercentileTest, MedianIsTheMiddleOrBetweenTheMiddleTwo) {
  std::vector<TypeParam> odd = {3, -1, 7};
  EXPECT_EQ(Median(&odd), 3);
  std::vector<TypeParam> even = {3, -1, 7, 2};
  EXPECT_EQ(Median(&even), 2.5);
  // The upper one of the two.
  EXPECT_EQ(Percentile(50, &even), 3);
}

}  // namespace percentile_test
}  // namespace colmap_ext
