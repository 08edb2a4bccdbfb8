#pragma once

namespace colmap_ext {

// Calls function(row, col) for all pixels of what has a width and a height.
template <typename Image, typename Function>
void ForEachPixel(const Image& image, const Function& function) {
  for (int row = 0; row < image.height; ++row) {
    for (int col = 0; col < image.width; ++col) {
      function(row, col);
    }
  }
}

}  // namespace colmap_ext
