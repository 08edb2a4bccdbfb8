#include "pictures/error_colors.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "base/percentile.h"

namespace colmap_ext {

Color ErrorColor(double error, double scale) {
  constexpr Color kViridis[] = {{68, 1, 84},    {72, 40, 120},  {62, 74, 137},
                                {49, 104, 142}, {38, 130, 142}, {31, 158, 137},
                                {53, 183, 121}, {109, 205, 89}, {180, 222, 44},
                                {253, 231, 37}};
  constexpr size_t kLast = std::size(kViridis) - 1;
  const double position = std::clamp(error / scale, 0.0, 1.0) * kLast;
  const size_t index = std::min(static_cast<size_t>(position), kLast - 1);
  const double weight = position - static_cast<double>(index);
  Color color;
  for (size_t i = 0; i < color.size(); ++i) {
    color[i] = static_cast<uint8_t>(std::lround(
        (1 - weight) * kViridis[index][i] + weight * kViridis[index + 1][i]));
  }
  return color;
}

double ErrorScale(std::vector<double> errors) {
  if (errors.empty()) {
    return 1;
  }
  const double most = Percentile(95, &errors);
  if (!(most > 0)) {
    return 1;
  }
  const double power = std::pow(10, std::floor(std::log10(most)));
  for (const double factor : {1, 2, 5}) {
    if (factor * power >= most) {
      return factor * power;
    }
  }
  return 10 * power;
}

}  // namespace colmap_ext
