#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "photometry/photometric_energy.h"
#include "scene/view.h"

namespace colmap_ext {

// Instructions that loops are compiled for. All of them round alike: nothing is
// contracted (cmake/CompilerFlags.cmake) and no sum is reordered.
enum class SimdLevel {
  kBaseline,  // what the compiler assumes of every processor
  kAvx2,      // vectors of 8 floats, x86-64
};

inline SimdLevel BestSimdLevel() {
#if defined(__x86_64__)
  static const bool has_avx2 = __builtin_cpu_supports("avx2");
  return has_avx2 ? SimdLevel::kAvx2 : SimdLevel::kBaseline;
#else
  return SimdLevel::kBaseline;
#endif
}

#if defined(__x86_64__)
template <typename Body>
__attribute__((target("avx2"))) void RunWithAvx2(const Body& body) {
  body();
}
#endif

// Calls body(), compiled for a level.
// \pre the processor has it; body is declared always_inline, and so is what it
//      calls
template <typename Body>
void RunAt(SimdLevel level, const Body& body) {
#if defined(__x86_64__)
  if (level == SimdLevel::kAvx2) {
    RunWithAvx2(body);
    return;
  }
#endif
  body();
}

// Sums over the pixels of the windows around those of a row, [width] each.
struct RowSums {
  std::array<std::vector<float>*, 6> All() {
    return {&count, &image, &warped, &image_squared, &warped_squared, &product};
  }

  std::vector<float> count, image, warped, image_squared, warped_squared,
      product;
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
  explicit WindowRows(const PhotometricOptions& options, SimdLevel level)
      : options_(options), radius_(options.window_radius), level_(level) {}

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
  void Correlate(int width, const RowSums& sums, const float* is_counted,
                 const WindowRow& row) const;

 private:
  // Rows of sums of columns, with `margin` before and behind each of them.
  // \return the first one; the others follow by width + 2 radius
  float* Columns(int num_rows, int width, float margin);

  PhotometricOptions options_;
  int radius_;
  SimdLevel level_;
  std::vector<float> columns_;
};

// A rectangle of pixels of image i: a core with the centres of the windows, and
// around it `radius` pixels that their windows reach. I_i and I_ij on it, and
// what their correlation yields. All arrays are [height * width].
struct CorrelationTile {
  int width = 0;   // px, with the margins
  int height = 0;  // px, with the margins

  std::vector<float> image;           // I_i, grey values
  std::vector<float> warped;          // I_ij
  std::vector<float> is_valid;        // 1 where I_ij is known, else 0
  std::vector<float> inverse_depths;  // drawn in i; where it is valid
  std::vector<uint8_t> is_center;     // 1: windows whose energy counts; 0 in
                                      // the margins
  std::vector<uint8_t> is_reached;    // 1: in the window of a centre

  std::vector<float> weights;      // w at the centres, 0 elsewhere and where
                                   // too little of the window is valid
  std::vector<float> energies;     // w c(ZNCC) at the centres, likewise
  std::vector<float> derivatives;  // of their sum by I_ij of each pixel
  std::vector<float> curvatures;   // likewise the second ones, Gauss-Newton's

  // Sets all arrays' sizes, their values are left as they were.
  void Resize(int new_width, int new_height);

  // Sets is_reached.
  // \pre is_center is set
  void FindReached(int radius);

  size_t Index(int row, int col) const {
    return static_cast<size_t>(row) * width + col;
  }
};

// Grey values squared: a window of less variance says nothing. A sum of squares
// up to 127^2 (means are subtracted) in floats is off by a few times 2^-24 of
// it, 1e-3 and more, and the variance is what is left of a difference of two
// such sums.
inline constexpr float kMinVariance = 1e-2F;

// The largest relative difference of inverse depths within one surface, over a
// window of image i. Pixels beyond it are masked (docs/method.md, section 5.4).
// \param radius  of the window, px
float MaxRelativeDepth(const PhotometricOptions& options, const View& view_i,
                       int radius);

// Zero-normalised cross correlation of I_i and I_ij in the windows around the
// centres, and its derivatives by I_ij (docs/method.md, sections 5.3 and 5.5).
// Holds scratch: each thread has its own.
class WindowCorrelation {
 public:
  explicit WindowCorrelation(const PhotometricOptions& options,
                             SimdLevel level = BestSimdLevel());

  // \param max_relative_depth  see MaxRelativeDepth().
  void Compute(float max_relative_depth, CorrelationTile* tile);

 private:
  // See WindowRow.
  struct Windows {
    void Assign(size_t size);  // zeros

    std::vector<float> by_image, by_warped, constants, curvatures;
  };

  void SubtractMeans(const CorrelationTile& tile);
  void FindBroken(const CorrelationTile& tile, int row);
  void CorrelateRow(int row, CorrelationTile* tile);
  template <typename Function>
  void ForEachPixel(const CorrelationTile& tile, int row, int col,
                    const Function& function) const;
  void CorrelateMasked(int row, CorrelationTile* tile);
  void CorrelateMaskedWindow(int row, int col, CorrelationTile* tile);
  void GatherDerivatives(int row, CorrelationTile* tile);

  PhotometricOptions options_;
  WindowRows rows_;
  float max_relative_depth_ = 0;

  // Scratch, [height * width].
  std::vector<float> image_, warped_;  // without their means; 0 where invalid
  std::vector<float> masked_derivatives_, masked_curvatures_;

  // Of the windows that no discontinuity runs through: [height + 2 radius]
  // [width], with rows of zeros above and below, so that every pixel has as
  // many rows of windows around it.
  Windows windows_;

  RowSums masked_sums_;  // of one window

  // Of a row, [width].
  RowSums sums_;
  std::vector<uint8_t> is_broken_;  // a discontinuity runs through the window
  std::vector<float> is_counted_;   // 1: of the others, those that count
  std::vector<float> lowest_, highest_;  // inverse depths of the windows
  Windows row_;                          // sums of windows_
};

}  // namespace colmap_ext
