#include "base/rows.h"

#include <algorithm>
#include <random>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "base/indices.h"
#include "base/percentile.h"
#include "tests/random.h"

namespace colmap_ext::rows_test {

TEST(GroupInRows, KeepsTheOrderWithinEachRow) {
  const std::vector<size_t> rows_of = {2, 0, 2, 4, 0, 2};
  const auto rows = GroupInRows<int>(5, [&](const auto& add) {
    for (size_t i = 0; i < rows_of.size(); ++i) {
      add(rows_of[i], static_cast<int>(10 * i));
    }
  });
  EXPECT_EQ(rows, Rows<int>({0, 2, 2, 5, 5, 6}, {10, 40, 0, 20, 50, 30}));
  EXPECT_EQ(GroupInRows<int>(0, [](const auto&) {}), Rows<int>());
}

TEST(EditRowsTest, KeepsWhatTheEditReturns) {
  std::mt19937 random(1);
  for (int trial = 0; trial < 100; ++trial) {
    Rows<int> rows;
    Rows<int> expected;
    const size_t num_rows = random() % 8;
    for (size_t i = 0; i < num_rows; ++i) {
      std::vector<int> row(random() % 5);
      for (int& value : row) {
        value = static_cast<int>(random() % 10);
      }
      rows.AddRow(row);
      if (i % 3 != 1) {  // below, these are dropped; even values stay
        std::erase_if(row, [](int value) { return value % 2 != 0; });
        expected.AddRow(row);
      }
    }
    size_t num_calls = 0;
    EditRows(
        [&num_calls](size_t i, std::span<int> row) -> std::optional<size_t> {
          EXPECT_EQ(i, num_calls++);
          if (i % 3 == 1) {
            return std::nullopt;
          }
          const auto end = std::remove_if(
              row.begin(), row.end(), [](int value) { return value % 2 != 0; });
          return static_cast<size_t>(end - row.begin());
        },
        &rows);
    EXPECT_EQ(num_calls, num_rows);
    EXPECT_EQ(rows, expected);
  }
}

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

template <typename T>
struct PercentileTest : testing::Test {
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
      std::ranges::sort(sorted);
      for (const double percent : {0.0, 12.5, 50.0, 90.0, 95.0, 100.0}) {
        check(percent, values, sorted);
      }
    }
  }

  static void ExpectSameValues(std::vector<T> reordered,
                               const std::vector<T>& sorted) {
    std::ranges::sort(reordered);
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

TYPED_TEST(PercentileTest, MedianIsTheMiddleOrBetweenTheMiddleTwo) {
  std::vector<TypeParam> odd = {3, -1, 7};
  EXPECT_EQ(Median(&odd), 3);
  std::vector<TypeParam> even = {3, -1, 7, 2};
  EXPECT_EQ(Median(&even), 2.5);
  // The upper one of the two.
  EXPECT_EQ(Percentile(50, &even), 3);
}

}  // namespace colmap_ext::rows_test
