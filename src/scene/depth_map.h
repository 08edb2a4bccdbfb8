#pragma once

#include <cstddef>
#include <vector>

namespace colmap_ext {

// Depths along the z axis of a view, of all pixels or of every `stride`-th
// pixel of every `stride`-th row, starting in the middle of the first `stride`.
// They belong to the centres of the pixels, (col + 0.5, row + 0.5), see View.
struct DepthMap {
  int width = 0;              // samples a row
  int height = 0;             // rows of samples
  int stride = 1;             // px
  std::vector<float> depths;  // [height * width], scene units; 0: nothing seen

  // The row (or column) of pixels that a row (or column) of samples is of.
  int Pixel(int sample) const { return sample * stride + stride / 2; }

  size_t Index(int row, int col) const {
    return static_cast<size_t>(row) * width + col;
  }
};

}  // namespace colmap_ext
