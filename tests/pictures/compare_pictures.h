#pragma once

#include <cstdlib>

#include "scene/images.h"

namespace colmap_ext {

// Between the values of red, green and blue, 0 ... 255; 255 where the sizes
// differ.
inline double MeanDifference(const ColorImage& a, const ColorImage& b) {
  if (a.pixels.size() != b.pixels.size() || a.pixels.empty()) {
    return 255;
  }
  double sum = 0;
  for (size_t i = 0; i < a.pixels.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      sum += std::abs(a.pixels[i][k] - b.pixels[i][k]);
    }
  }
  return sum / static_cast<double>(3 * a.pixels.size());
}

inline bool IsRed(const Color& color) {
  return color[0] > 2 * color[1] && color[0] > 2 * color[2];
}

}  // namespace colmap_ext
