#include "pictures/error_colors.h"

#include <gtest/gtest.h>

namespace colmap_ext {
namespace error_colors_test {

TEST(ErrorColor, GoesFromOneEndOfTheScaleToTheOther) {
  EXPECT_EQ(ErrorColor(0, 2), (Color{68, 1, 84}));
  EXPECT_EQ(ErrorColor(2, 2), (Color{253, 231, 37}));
  EXPECT_EQ(ErrorColor(7, 2), ErrorColor(2, 2));
  for (int i = 0; i < 100; ++i) {  // green only grows
    EXPECT_LE(ErrorColor(i, 100)[1], ErrorColor(i + 1, 100)[1]);
  }
}

TEST(ErrorScale, IsRoundAndAboveMostErrors) {
  EXPECT_DOUBLE_EQ(ErrorScale({0.0013}), 0.002);
  EXPECT_DOUBLE_EQ(ErrorScale({30}), 50);
  EXPECT_DOUBLE_EQ(ErrorScale({7}), 10);
  EXPECT_EQ(ErrorScale({0, 0}), 1);
  EXPECT_EQ(ErrorScale({}), 1);
  std::vector<double> errors(99, 1.5);
  errors.push_back(1000);
  EXPECT_EQ(ErrorScale(errors), 2);
}

}  // namespace error_colors_test
}  // namespace colmap_ext
