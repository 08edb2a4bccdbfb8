#include "evaluation/distance_statistics.h"

#include <cmath>

#include <gtest/gtest.h>

namespace colmap_ext {
namespace distance_statistics_test {

TEST(Summarize, ClipsOrDropsWhatIsBeyond) {
  const std::vector<double> distances = {10, 1, 4, 10, 3, 2};
  const DistanceStatistics clipped = Summarize(distances, 10, false);
  EXPECT_EQ(clipped.num_samples, 6);
  EXPECT_EQ(clipped.num_beyond, 2);
  EXPECT_DOUBLE_EQ(clipped.mean, 5);
  EXPECT_DOUBLE_EQ(clipped.median, 3.5);
  EXPECT_DOUBLE_EQ(clipped.percentile90, 10);
  const DistanceStatistics dropped = Summarize(distances, 10, true);
  EXPECT_EQ(dropped.num_samples, 6);
  EXPECT_EQ(dropped.num_beyond, 2);
  EXPECT_DOUBLE_EQ(dropped.mean, 2.5);
  EXPECT_DOUBLE_EQ(dropped.median, 2.5);
  EXPECT_DOUBLE_EQ(dropped.percentile90, 3.7);
}

TEST(Summarize, OfOddNumbersTheMedianIsTheMiddleOne) {
  EXPECT_EQ(Summarize({5, 1, 2}, 10, false).median, 2);
  EXPECT_EQ(Summarize({5}, 10, false).percentile90, 5);
}

TEST(Summarize, IsNotANumberWhereThereIsNothing) {
  for (const DistanceStatistics& statistics :
       {Summarize({}, 1, false), Summarize({1, 1}, 1, true)}) {
    EXPECT_TRUE(std::isnan(statistics.mean));
    EXPECT_TRUE(std::isnan(statistics.median));
    EXPECT_TRUE(std::isnan(statistics.percentile90));
  }
}

}  // namespace distance_statistics_test
}  // namespace colmap_ext
