#include "photometry/interpolation.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace colmap_ext {

namespace {

// Four values side by side (GCC and Clang).
using Float4 = float __attribute__((vector_size(16)));
using Byte4 = uint8_t __attribute__((vector_size(4)));

// Weights of the four samples around a point a fraction `x` behind the second
// one [Catmull1974].
Float4 CubicWeights(float x) {
  constexpr Float4 kCubed{-0.5F, 1.5F, -1.5F, 0.5F};
  constexpr Float4 kSquared{1, -2.5F, 2, -0.5F};
  constexpr Float4 kLinear{-0.5F, 0, 0.5F, 0};
  constexpr Float4 kConstant{0, 1, 0, 0};
  return ((kCubed * x + kSquared) * x + kLinear) * x + kConstant;
}

// Their derivatives by x.
Float4 CubicSlopes(float x) {
  constexpr Float4 kSquared{-1.5F, 4.5F, -4.5F, 1.5F};
  constexpr Float4 kLinear{2, -5, 4, -1};
  constexpr Float4 kConstant{-0.5F, 0, 0.5F, 0};
  return (kSquared * x + kLinear) * x + kConstant;
}

Float4 Grays(const uint8_t* pixels) {
  Byte4 bytes;
  std::memcpy(&bytes, pixels, sizeof(bytes));
  return __builtin_convertvector(bytes, Float4);
}

float Sum(Float4 values) {
  return (values[0] + values[2]) + (values[1] + values[3]);
}

// The sixteen pixels from (row, col) on, of which the image need not have all.
void CopyClamped(const GrayImage& image, int row, int col,
                 std::array<uint8_t, 16>* pixels) {
  for (int k = 0; k < 4; ++k) {
    const uint8_t* line = image.Row(std::clamp(row + k, 0, image.height - 1));
    for (int l = 0; l < 4; ++l) {
      (*pixels)[4 * k + l] = line[std::clamp(col + l, 0, image.width - 1)];
    }
  }
}

}  // namespace

Interpolated Interpolate(const GrayImage& image, double u, double v) {
  const int col = std::min(static_cast<int>(u - 0.5), image.width - 2);
  const int row = std::min(static_cast<int>(v - 0.5), image.height - 2);
  std::array<uint8_t, 16> copy;
  const uint8_t* pixels = copy.data();
  ptrdiff_t stride = 4;
  if (col >= 1 && row >= 1 && col + 2 < image.width && row + 2 < image.height) {
    pixels = image.Row(row - 1) + col - 1;
    stride = image.width;
  } else {
    CopyClamped(image, row - 1, col - 1, &copy);
  }
  const auto x = static_cast<float>(u - 0.5 - col);
  const auto y = static_cast<float>(v - 0.5 - row);
  const Float4 by_row = CubicWeights(y);
  const Float4 slopes_by_row = CubicSlopes(y);
  Float4 values{};  // of the four columns
  Float4 slopes{};
  for (int k = 0; k < 4; ++k) {
    const Float4 grays = Grays(pixels + k * stride);
    values += by_row[k] * grays;
    slopes += slopes_by_row[k] * grays;
  }
  const Float4 by_col = CubicWeights(x);
  return {Sum(by_col * values), Sum(CubicSlopes(x) * values),
          Sum(by_col * slopes)};
}

}  // namespace colmap_ext
