#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/simd_level.h"
#include "photometry/photometric_energy.h"
#include "photometry/window_rows.h"
#include "scene/view.h"

namespace colmap_ext {

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
float MaxRelativeDepth(const PhotometricOptions& options, const View& view_i);

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
  void FindBroken(float max_relative_depth, const CorrelationTile& tile,
                  int row);
  void CorrelateRow(int row, CorrelationTile* tile);
  template <typename Function>
  void ForEachPixel(float max_relative_depth, const CorrelationTile& tile,
                    int row, int col, const Function& function) const;
  void CorrelateMasked(float max_relative_depth, int row,
                       CorrelationTile* tile);
  void CorrelateMaskedWindow(float max_relative_depth, int row, int col,
                             CorrelationTile* tile);
  void GatherDerivatives(int row, CorrelationTile* tile);

  PhotometricOptions options_;
  WindowConstants constants_;
  WindowRows rows_;

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
