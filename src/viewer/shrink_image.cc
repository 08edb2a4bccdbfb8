#include "viewer/shrink_image.h"

#include <algorithm>
#include <array>
#include <cstdint>

namespace colmap_ext {

namespace {

// The first pixel that pixel i of the small picture covers.
int First(int i, int small_size, int size) {
  return static_cast<int>(static_cast<int64_t>(i) * size / small_size);
}

Color Mean(const ColorImage& image, int first_row, int end_row, int first_col,
           int end_col) {
  std::array<uint64_t, 3> sums = {0, 0, 0};
  for (int row = first_row; row < end_row; ++row) {
    for (int col = first_col; col < end_col; ++col) {
      for (int k = 0; k < 3; ++k) {
        sums[k] += image.At(row, col)[k];
      }
    }
  }
  const uint64_t count =
      static_cast<uint64_t>(end_row - first_row) * (end_col - first_col);
  Color mean;
  for (int k = 0; k < 3; ++k) {
    mean[k] = static_cast<uint8_t>((sums[k] + count / 2) / count);
  }
  return mean;
}

}  // namespace

ColorImage ShrinkImage(ColorImage image, int max_size) {
  const int longest = std::max(image.width, image.height);
  if (longest <= max_size) {
    return image;
  }
  ColorImage small;
  small.width = std::max(1, First(image.width, longest, max_size));
  small.height = std::max(1, First(image.height, longest, max_size));
  small.pixels.reserve(static_cast<size_t>(small.width) * small.height);
  for (int row = 0; row < small.height; ++row) {
    for (int col = 0; col < small.width; ++col) {
      small.pixels.push_back(Mean(image, First(row, small.height, image.height),
                                  First(row + 1, small.height, image.height),
                                  First(col, small.width, image.width),
                                  First(col + 1, small.width, image.width)));
    }
  }
  return small;
}

}  // namespace colmap_ext
