#include "photometry/window_correlation.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace colmap_ext {

float MaxRelativeDepth(const PhotometricOptions& options, const View& view_i) {
  // Footprints of a pixel that depths of one surface may differ by for each
  // pixel between them: a slope of 76 degrees, at which a facet shows a quarter
  // of its area. What the masks do: docs/benchmarks.md, row "no occlusion
  // masks" (bunny).
  constexpr double kMaxSlope = 4;
  return options.occlusion_masking
             ? static_cast<float>(kMaxSlope * options.window_radius /
                                  std::min(view_i.fx, view_i.fy))
             : std::numeric_limits<float>::max();
}

void CorrelationTile::Resize(int new_width, int new_height) {
  width = new_width;
  height = new_height;
  const size_t size = static_cast<size_t>(width) * height;
  for (auto* plane : {&image, &warped, &is_valid, &inverse_depths, &weights,
                      &energies, &derivatives, &curvatures}) {
    plane->resize(size);
  }
  is_center.resize(size);
  is_reached.resize(size);
}

void CorrelationTile::FindReached(int radius) {
  std::fill(is_reached.begin(), is_reached.end(), 0);
  std::vector<uint8_t> reached(width);
  for (int row = radius; row < height - radius; ++row) {
    const uint8_t* centers = is_center.data() + Index(row, 0);
    std::fill(reached.begin(), reached.end(), 0);
    for (int k = -radius; k <= radius; ++k) {
      for (int col = radius; col < width - radius; ++col) {
        reached[col + k] |= centers[col];
      }
    }
    for (int other = row - radius; other <= row + radius; ++other) {
      uint8_t* to = is_reached.data() + Index(other, 0);
      for (int col = 0; col < width; ++col) {
        to[col] |= reached[col];
      }
    }
  }
}

// docs/method.md, sections 5.3 and 5.5. With N pixels, means I' and J',
// variances A and B, covariance C:
//   w c(ZNCC), c(Z) = s log(1 - Z / s), dc / dZ = -s / (s - Z)
//   ZNCC = C / sqrt(A B)
//   dZNCC / dJ(y) = ((I(y) - I') / sqrt(A B) - ZNCC (J(y) - J') / B) / N
//   w = m / (m + e), m = min(A, B)
//   dw / dJ(y) = e / (m + e)^2 * 2 (J(y) - J') / N if B < A, else 0.
// 1 - ZNCC is half the squared distance of I and J, normalised. Gauss-Newton's
// second derivative is the square of that distance's first one, 1 / (N B),
// times w |dc / dZ|: without what couples the pixels of a window, and without
// the derivative of the normalisation.
inline WindowCorrelation::Window WindowCorrelation::Correlate(
    const Sums& sums) const {
  // More than half of the window has to be seen: the centre's surface is the
  // larger part of it.
  constexpr float kMinShare = 0.5F;
  const int side = 2 * options_.window_radius + 1;
  const float scale = 1 / std::max(sums.count, 1.0F);
  const float mean_image = sums.image * scale;
  const float mean_warped = sums.warped * scale;
  const float a =
      std::max(sums.image_squared * scale - mean_image * mean_image, 0.0F);
  const float b =
      std::max(sums.warped_squared * scale - mean_warped * mean_warped, 0.0F);
  const float covariance = sums.product * scale - mean_image * mean_warped;
  const float smaller = std::min(a, b);
  const bool is_good =
      sums.count > kMinShare * side * side && smaller > kMinVariance;
  const float safe_b = is_good ? b : 1.0F;
  const float root = is_good ? std::sqrt(a * b) : 1.0F;
  // Rounding can leave the range.
  const float zncc = std::clamp(covariance / root, -1.0F, 1.0F);
  const float noisy = smaller + static_cast<float>(options_.noise_variance);
  const float weight = is_good ? smaller / noisy : 0.0F;
  const float weight_slope =
      is_good && b < a
          ? static_cast<float>(options_.noise_variance) / (noisy * noisy)
          : 0.0F;
  const float slope = saturation_ / (saturation_ - zncc);
  const auto cost = static_cast<float>(
      saturation_ * std::log(1 - zncc / static_cast<double>(saturation_)));
  Window window;
  window.weight = weight;
  window.energy = weight * cost;
  window.by_image = -weight * slope * scale / root;
  window.by_warped =
      scale * (zncc * weight * slope / safe_b + 2 * cost * weight_slope);
  window.constant =
      -window.by_image * mean_image - window.by_warped * mean_warped;
  window.curvature = weight * slope * scale / safe_b;
  return window;
}

// Of the part of each pixel's window that lies on the tile.
void WindowCorrelation::BoxSum(const std::vector<float>& in,
                               const CorrelationTile& tile,
                               std::vector<float>* out) {
  const int radius = options_.window_radius;
  const int width = tile.width;
  out->assign(in.size(), 0);
  rows_.assign(in.size(), 0);
  for (int row = 0; row < tile.height; ++row) {
    float* sum = rows_.data() + tile.Index(row, 0);
    const int first = std::max(row - radius, 0);
    const int last = std::min(row + radius, tile.height - 1);
    for (int other = first; other <= last; ++other) {
      const float* from = in.data() + tile.Index(other, 0);
      for (int col = 0; col < width; ++col) {
        sum[col] += from[col];
      }
    }
    float* to = out->data() + tile.Index(row, 0);
    for (int k = -radius; k <= radius; ++k) {
      for (int col = std::max(-k, 0); col < width - std::max(k, 0); ++col) {
        to[col] += sum[col + k];
      }
    }
  }
}

// Correlation does not depend on means; without them less is lost to rounding.
void WindowCorrelation::SubtractMeans(const CorrelationTile& tile) {
  const size_t size = tile.image.size();
  double count = 0;
  double sum_image = 0;
  double sum_warped = 0;
  for (size_t i = 0; i < size; ++i) {
    count += tile.is_valid[i];
    sum_image += tile.is_valid[i] * tile.image[i];
    sum_warped += tile.is_valid[i] * tile.warped[i];
  }
  const auto mean_image = static_cast<float>(sum_image / std::max(count, 1.0));
  const auto mean_warped =
      static_cast<float>(sum_warped / std::max(count, 1.0));
  image_.resize(size);
  warped_.resize(size);
  for (size_t i = 0; i < size; ++i) {
    image_[i] = tile.is_valid[i] * (tile.image[i] - mean_image);
    warped_[i] = tile.is_valid[i] * (tile.warped[i] - mean_warped);
  }
}

// The ranges of the inverse depths in the columns of the windows of a row: to
// plane_ the highest, to rows_ the lowest.
void WindowCorrelation::FindDepthRanges(const CorrelationTile& tile, int row) {
  constexpr float kMax = std::numeric_limits<float>::max();
  float* low = rows_.data() + tile.Index(row, 0);
  float* high = plane_.data() + tile.Index(row, 0);
  for (int k = -options_.window_radius; k <= options_.window_radius; ++k) {
    const size_t other = tile.Index(row + k, 0);
    for (int col = 0; col < tile.width; ++col) {
      const float depth = tile.inverse_depths[other + col];
      const bool is_valid = tile.is_valid[other + col] > 0;
      low[col] = std::min(low[col], is_valid ? depth : kMax);
      high[col] = std::max(high[col], is_valid ? depth : 0.0F);
    }
  }
}

void WindowCorrelation::FindDiscontinuities(float max_relative_depth,
                                            const CorrelationTile& tile) {
  const int radius = options_.window_radius;
  is_broken_.assign(tile.image.size(), 0);
  if (!options_.occlusion_masking) {
    return;
  }
  rows_.assign(tile.image.size(), std::numeric_limits<float>::max());
  plane_.assign(tile.image.size(), 0);
  for (int row = radius; row < tile.height - radius; ++row) {
    FindDepthRanges(tile, row);
    const size_t begin = tile.Index(row, 0);
    for (int col = radius; col < tile.width - radius; ++col) {
      const float center = tile.inverse_depths[begin + col];
      float lowest = center;
      float highest = center;
      for (int k = -radius; k <= radius; ++k) {
        lowest = std::min(lowest, rows_[begin + col + k]);
        highest = std::max(highest, plane_[begin + col + k]);
      }
      is_broken_[begin + col] = std::max(highest - center, center - lowest) >
                                max_relative_depth * center;
    }
  }
}

// The windows that no discontinuity runs through, all at a time.
void WindowCorrelation::CorrelateWhole(CorrelationTile* tile) {
  const size_t size = tile->image.size();
  plane_.resize(size);
  BoxSum(tile->is_valid, *tile, &count_);
  BoxSum(image_, *tile, &sum_image_);
  BoxSum(warped_, *tile, &sum_warped_);
  const auto box_sum_of_products = [&](const std::vector<float>& a,
                                       const std::vector<float>& b,
                                       std::vector<float>* out) {
    for (size_t i = 0; i < size; ++i) {
      plane_[i] = a[i] * b[i];
    }
    BoxSum(plane_, *tile, out);
  };
  box_sum_of_products(image_, image_, &sum_image_squared_);
  box_sum_of_products(warped_, warped_, &sum_warped_squared_);
  box_sum_of_products(image_, warped_, &sum_product_);
  for (auto* plane : {&by_image_, &by_warped_, &constant_, &curvature_}) {
    plane->resize(size);
  }
  for (size_t i = 0; i < size; ++i) {
    Window window;
    if (tile->is_center[i] != 0 && is_broken_[i] == 0 &&
        tile->is_valid[i] > 0) {
      window = Correlate({count_[i], sum_image_[i], sum_warped_[i],
                          sum_image_squared_[i], sum_warped_squared_[i],
                          sum_product_[i]});
    }
    tile->weights[i] = window.weight;
    tile->energies[i] = window.energy;
    by_image_[i] = window.by_image;
    by_warped_[i] = window.by_warped;
    constant_[i] = window.constant;
    curvature_[i] = window.curvature;
  }
}

// Whether the window counts, and a discontinuity runs through it.
bool WindowCorrelation::IsMasked(const CorrelationTile& tile,
                                 size_t center) const {
  return is_broken_[center] != 0 && tile.is_center[center] != 0 &&
         tile.is_valid[center] > 0;
}

// Calls function(i) for the pixels of a window on the surface of its centre.
template <typename Function>
void WindowCorrelation::ForEachPixel(float max_relative_depth,
                                     const CorrelationTile& tile, int row,
                                     int col, const Function& function) const {
  const int radius = options_.window_radius;
  const float center = tile.inverse_depths[tile.Index(row, col)];
  for (int y = row - radius; y <= row + radius; ++y) {
    for (int x = col - radius; x <= col + radius; ++x) {
      const size_t i = tile.Index(y, x);
      if (tile.is_valid[i] > 0 && std::abs(tile.inverse_depths[i] - center) <=
                                      max_relative_depth * center) {
        function(i);
      }
    }
  }
}

void WindowCorrelation::CorrelateMaskedWindow(float max_relative_depth, int row,
                                              int col, CorrelationTile* tile) {
  Sums sums;
  ForEachPixel(max_relative_depth, *tile, row, col, [&](size_t i) {
    sums.count += 1;
    sums.image += image_[i];
    sums.warped += warped_[i];
    sums.image_squared += image_[i] * image_[i];
    sums.warped_squared += warped_[i] * warped_[i];
    sums.product += image_[i] * warped_[i];
  });
  const Window window = Correlate(sums);
  if (!(window.weight > 0)) {
    return;
  }
  const size_t center = tile->Index(row, col);
  tile->weights[center] = window.weight;
  tile->energies[center] = window.energy;
  ForEachPixel(max_relative_depth, *tile, row, col, [&](size_t i) {
    masked_derivatives_[i] += window.by_image * image_[i] +
                              window.by_warped * warped_[i] + window.constant;
    masked_curvatures_[i] += window.curvature;
  });
}

// The others, one by one: pixels across the discontinuity are left out
// [Romanoni2019].
void WindowCorrelation::CorrelateMasked(float max_relative_depth,
                                        CorrelationTile* tile) {
  const int radius = options_.window_radius;
  masked_derivatives_.assign(tile->image.size(), 0);
  masked_curvatures_.assign(tile->image.size(), 0);
  for (int row = radius; row < tile->height - radius; ++row) {
    for (int col = radius; col < tile->width - radius; ++col) {
      if (IsMasked(*tile, tile->Index(row, col))) {
        CorrelateMaskedWindow(max_relative_depth, row, col, tile);
      }
    }
  }
}

// Each pixel's from the windows that contain it. The sums run over the margins
// too, where there are no centres.
void WindowCorrelation::GatherDerivatives(CorrelationTile* tile) {
  BoxSum(by_image_, *tile, &sum_image_);
  BoxSum(by_warped_, *tile, &sum_warped_);
  BoxSum(constant_, *tile, &count_);
  BoxSum(curvature_, *tile, &sum_product_);
  for (size_t i = 0; i < tile->image.size(); ++i) {
    const float valid = tile->is_valid[i];
    tile->derivatives[i] =
        valid * (image_[i] * sum_image_[i] + warped_[i] * sum_warped_[i] +
                 count_[i] + masked_derivatives_[i]);
    tile->curvatures[i] = valid * (sum_product_[i] + masked_curvatures_[i]);
  }
}

void WindowCorrelation::Compute(float max_relative_depth,
                                CorrelationTile* tile) {
  SubtractMeans(*tile);
  FindDiscontinuities(max_relative_depth, *tile);
  CorrelateWhole(tile);
  CorrelateMasked(max_relative_depth, tile);
  GatherDerivatives(tile);
}

}  // namespace colmap_ext
