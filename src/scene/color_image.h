#pragma once

#include <cstddef>
#include <vector>

#include "scene/point_cloud.h"

namespace colmap_ext {

// Pixel (row, col) has its centre at (u, v) = (col + 0.5, row + 0.5), see View.
struct ColorImage {
  int width = 0;              // px
  int height = 0;             // px
  std::vector<Color> pixels;  // [height * width], rows from the top

  const Color& At(int row, int col) const {
    return pixels[static_cast<size_t>(row) * width + col];
  }
};

}  // namespace colmap_ext
