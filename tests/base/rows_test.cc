#include "base/rows.h"

#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace colmap_ext {
namespace rows_test {

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

}  // namespace rows_test
}  // namespace colmap_ext
