#include "base/streamed_quantile.h"

#include <cmath>

#include <gtest/gtest.h>

#include "base/percentile.h"
#include "tests/random.h"

namespace colmap_ext {
namespace {

TEST(StreamedQuantile, IsThePercentile) {
  Random random(1);
  for (const size_t size : {1, 2, 3, 7, 100, 5001}) {
    std::vector<float> values;
    for (size_t i = 0; i < size; ++i) {
      values.push_back(static_cast<float>(
          random.Chance(0.1) ? 0 : std::exp(4 * random.Unit())));
    }
    for (const double percent : {0.0, 12.5, 50.0, 95.0, 100.0}) {
      StreamedQuantile quantile;
      for (const float value : values) {
        quantile.Count(value, 1);
      }
      EXPECT_EQ(quantile.Total(), size);
      quantile.Seek(1 +
                    std::round(percent / 100 * static_cast<double>(size - 1)));
      for (const float value : values) {
        quantile.Keep(value, 1);
      }
      std::vector<float> sorted = values;
      EXPECT_EQ(quantile.Find(), Percentile(percent, &sorted));
    }
  }
}

TEST(StreamedQuantile, WeighsTheValues) {
  StreamedQuantile quantile;
  const std::pair<double, double> values[] = {{5, 1}, {1, 2}, {9, 2}, {2, 1}};
  for (const auto& [value, weight] : values) {
    quantile.Count(value, weight);
  }
  quantile.Seek(quantile.Total() / 2);
  for (const auto& [value, weight] : values) {
    quantile.Keep(value, weight);
  }
  EXPECT_EQ(quantile.Find(), 2);
}

TEST(StreamedQuantile, OfNothingIsZero) {
  StreamedQuantile quantile;
  quantile.Seek(0);
  EXPECT_EQ(quantile.Find(), 0);
}

}  // namespace
}  // namespace colmap_ext
