#include "photometry/interpolation.h"

#include <algorithm>

#include <Eigen/Core>

namespace colmap_ext {

namespace {

// Weights of the four samples around a point a fraction `x` behind the second
// one, and their derivatives [Catmull1974].
struct CubicWeights {
  explicit CubicWeights(float x)
      : values{x * (-0.5F + x * (1 - 0.5F * x)), 1 + x * x * (-2.5F + 1.5F * x),
               x * (0.5F + x * (2 - 1.5F * x)), x * x * (-0.5F + 0.5F * x)},
        slopes{-0.5F + x * (2 - 1.5F * x), x * (-5 + 4.5F * x),
               0.5F + x * (4 - 4.5F * x), x * (-1 + 1.5F * x)} {}

  Eigen::Array4f values;
  Eigen::Array4f slopes;
};

}  // namespace

Interpolated Interpolate(const GrayImage& image, double u, double v) {
  const int col = std::min(static_cast<int>(u - 0.5), image.width - 2);
  const int row = std::min(static_cast<int>(v - 0.5), image.height - 2);
  const CubicWeights by_col(static_cast<float>(u - 0.5 - col));
  const CubicWeights by_row(static_cast<float>(v - 0.5 - row));
  const bool is_inside = col >= 1 && col + 2 < image.width;
  // Of the four columns.
  Eigen::Array4f values = Eigen::Array4f::Zero();
  Eigen::Array4f slopes = Eigen::Array4f::Zero();
  for (int k = 0; k < 4; ++k) {
    const uint8_t* line =
        image.Row(std::clamp(row + k - 1, 0, image.height - 1));
    Eigen::Array4f grays;
    for (int l = 0; l < 4; ++l) {
      const int at = col + l - 1;
      grays[l] = line[is_inside ? at : std::clamp(at, 0, image.width - 1)];
    }
    values += by_row.values[k] * grays;
    slopes += by_row.slopes[k] * grays;
  }
  return {(by_col.values * values).sum(), (by_col.slopes * values).sum(),
          (by_col.values * slopes).sum()};
}

}  // namespace colmap_ext
