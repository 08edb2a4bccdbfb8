#pragma once

#include <cstddef>
#include <vector>

namespace colmap_ext {

// Depths along the z axis of a view, of the whole image or of some pixels of
// it: every `stride`-th of every `stride`-th row, from the middle of the first
// `stride` on.
struct DepthMap {
  int width = 0;              // samples a row
  int height = 0;             // rows of samples
  int stride = 1;             // px
  std::vector<float> depths;  // [height * width], scene units; 0: nothing seen

  // The pixel, on either axis, of a row's or column's samples.
  int Pixel(int sample) const { return sample * stride + stride / 2; }

  size_t Index(int row, int col) const {
    return static_cast<size_t>(row) * width + col;
  }
};

}  // namespace colmap_ext
