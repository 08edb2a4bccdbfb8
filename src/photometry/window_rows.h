#pragma once

#include <array>
#include <vector>

#include "base/simd_level.h"

namespace colmap_ext {

// Sums over the pixels of the windows around those of a row, [width] each.
struct RowSums {
  std::array<std::vector<float>*, 6> All() {
    return {&count, &image, &warped, &image_squared, &warped_squared, &product};
  }

  std::vector<float> count, image, warped, image_squared, warped_squared,
      product;
};

struct WindowConstants {
  float min_count = 0;       // pixels: more of a window have to be seen
  float min_variance = 0;    // grey values squared, likewise of both images
  float noise_variance = 0;  // grey values squared
  float saturation = 1;      // s of docs/method.md, section 5.1
};

// Of the windows of a row, [width] each: the value w c, its weight, its
// derivative by I_ij of a pixel, by_image I_i + by_warped I_ij + constant
// there, and the second derivative.
struct WindowRow {
  float* weights;
  float* energies;
  float* by_image;
  float* by_warped;
  float* constants;
  float* curvatures;
};

// The arithmetic of square windows, for the windows around the pixels of one
// row at a time: the quicker if `width` is a multiple of 8. Planes are given
// from the row `radius` above on, with a stride of `width`; of a window that
// reaches beyond the row's ends, the part on the row counts. Holds scratch:
// each thread has its own.
class WindowRows {
 public:
  // \pre 1 <= radius <= 7
  explicit WindowRows(int radius, SimdLevel level = BestSimdLevel())
      : radius_(radius), level_(level) {}

  // \param is_valid  1 or 0; the images are 0 where it is 0.
  void Sum(int width, const float* image, const float* warped,
           const float* is_valid, RowSums* sums);

  // The sums of any plane.
  void Sum(int width, const float* values, float* sums);

  // The lowest and the highest of the values that are valid, and the centre's.
  void FindRange(int width, const float* values, const float* is_valid,
                 float* lowest, float* highest);

  // The correlations (docs/method.md, sections 5.3 and 5.5).
  // \param is_counted  [width] 1, or 0: the window yields zeros.
  void Correlate(const WindowConstants& constants, int width,
                 const RowSums& sums, const float* is_counted,
                 const WindowRow& row) const;

 private:
  // Rows of sums of columns, with `margin` before and behind each of them.
  // \return the first one; the others follow by width + 2 radius
  float* Columns(int num_rows, int width, float margin);

  int radius_;
  SimdLevel level_;
  std::vector<float> columns_;
};

}  // namespace colmap_ext
