#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <vector>

namespace colmap_ext {

// All of these take any order of the values, and reorder them.
// \pre values are not empty and not NaN; percent is 0 ... 100

// Returns the value of the nearest rank, percent / 100 of the way from the
// smallest to the largest; halves are rounded up, as COLMAP rounds them.
template <std::floating_point T>
T Percentile(double percent, std::vector<T>* values) {
  const double last = static_cast<double>(values->size() - 1);
  const auto nth = values->begin() + static_cast<std::ptrdiff_t>(
                                         std::round(percent / 100 * last));
  std::nth_element(values->begin(), nth, values->end());
  return *nth;
}

// Between the values of two ranks it is interpolated linearly.
template <std::floating_point T>
T InterpolatedPercentile(double percent, std::vector<T>* values) {
  const double rank = percent / 100 * static_cast<double>(values->size() - 1);
  const auto lower =
      values->begin() + static_cast<std::ptrdiff_t>(std::floor(rank));
  std::nth_element(values->begin(), lower, values->end());
  if (lower + 1 == values->end()) {
    return *lower;
  }
  const T upper = *std::min_element(lower + 1, values->end());
  const auto weight = static_cast<T>(rank - std::floor(rank));
  return (1 - weight) * *lower + weight * upper;
}

// Of an even number of values the mean of the middle two.
template <std::floating_point T>
T Median(std::vector<T>* values) {
  return InterpolatedPercentile(50, values);
}

}  // namespace colmap_ext
