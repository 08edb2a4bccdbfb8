#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace colmap_ext {

// The value at or below which the given share (0 ... 100 percent) of the values
// lies, rounded to an element as COLMAP rounds it. Reorders the values.
// \pre !values->empty()
inline float Percentile(double percent, std::vector<float>* values) {
  const double last = static_cast<double>(values->size() - 1);
  const auto nth = values->begin() + static_cast<std::ptrdiff_t>(
                                         std::round(percent / 100 * last));
  std::nth_element(values->begin(), nth, values->end());
  return *nth;
}

}  // namespace colmap_ext
