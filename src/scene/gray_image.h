#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace colmap_ext {

// Pixel (row, col) has its centre at (u, v) = (col + 0.5, row + 0.5), see View.
struct GrayImage {
  int width = 0;                // px
  int height = 0;               // px
  std::vector<uint8_t> pixels;  // [height * width], rows from the top

  const uint8_t* Row(int row) const {
    return pixels.data() + static_cast<size_t>(row) * width;
  }
};

// Whether a grey value may stand for a brighter or darker one. What such pixels
// show is no texture.
inline bool IsSaturated(uint8_t gray) { return gray == 0 || gray == 255; }

// Reads the image of a view, in the size that the view has.
using ReadGrayImage = std::function<GrayImage(size_t view)>;

}  // namespace colmap_ext
