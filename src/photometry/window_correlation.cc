#include "photometry/window_correlation.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace colmap_ext {

float MaxRelativeDepth(const PhotometricOptions& options, const View& view_i,
                       int radius) {
  // Footprints of a pixel that depths of one surface may differ by for each
  // pixel between them: a slope of 76 degrees, at which a facet shows a quarter
  // of its area. What the masks do: docs/experiments.md, row "no occlusion
  // masks" (bunny).
  constexpr double kMaxSlope = 4;
  return options.occlusion_masking
             ? static_cast<float>(kMaxSlope * radius /
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
  std::ranges::fill(is_reached, 0);
  std::vector<uint8_t> reached(width);
  for (int row = radius; row < height - radius; ++row) {
    const uint8_t* centers = is_center.data() + Index(row, 0);
    std::ranges::fill(reached, 0);
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

WindowCorrelation::WindowCorrelation(const PhotometricOptions& options,
                                     SimdLevel level)
    : options_(options), rows_(options, level) {}

void WindowCorrelation::Windows::Assign(size_t size) {
  for (auto* plane : {&by_image, &by_warped, &constants, &curvatures}) {
    plane->assign(size, 0);
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

// Tells which windows of a row a discontinuity runs through.
void WindowCorrelation::FindBroken(const CorrelationTile& tile, int row) {
  const int width = tile.width;
  is_broken_.assign(width, 0);
  if (!options_.occlusion_masking) {
    return;
  }
  const size_t top = tile.Index(row - options_.window_radius, 0);
  rows_.FindRange(width, tile.inverse_depths.data() + top,
                  tile.is_valid.data() + top, lowest_.data(), highest_.data());
  const float* centers = tile.inverse_depths.data() + tile.Index(row, 0);
  for (int col = 0; col < width; ++col) {
    const float center = centers[col];
    is_broken_[col] = std::max(highest_[col] - center, center - lowest_[col]) >
                      max_relative_depth_ * center;
  }
}

// The windows of a row that no discontinuity runs through, all at a time.
void WindowCorrelation::CorrelateRow(int row, CorrelationTile* tile) {
  const int width = tile->width;
  const size_t top = tile->Index(row - options_.window_radius, 0);
  const size_t at = tile->Index(row, 0);
  const size_t padded = tile->Index(row + options_.window_radius, 0);
  rows_.Sum(width, image_.data() + top, warped_.data() + top,
            tile->is_valid.data() + top, &sums_);
  for (int col = 0; col < width; ++col) {
    is_counted_[col] = tile->is_center[at + col] != 0 && is_broken_[col] == 0
                           ? tile->is_valid[at + col]
                           : 0;
  }
  rows_.Correlate(
      width, sums_, is_counted_.data(),
      {tile->weights.data() + at, tile->energies.data() + at,
       windows_.by_image.data() + padded, windows_.by_warped.data() + padded,
       windows_.constants.data() + padded,
       windows_.curvatures.data() + padded});
}

// Calls function(i) for the pixels of a window on the surface of its centre.
template <typename Function>
void WindowCorrelation::ForEachPixel(const CorrelationTile& tile, int row,
                                     int col, const Function& function) const {
  const int radius = options_.window_radius;
  const float center = tile.inverse_depths[tile.Index(row, col)];
  for (int y = row - radius; y <= row + radius; ++y) {
    for (int x = col - radius; x <= col + radius; ++x) {
      const size_t i = tile.Index(y, x);
      if (tile.is_valid[i] > 0 && std::abs(tile.inverse_depths[i] - center) <=
                                      max_relative_depth_ * center) {
        function(i);
      }
    }
  }
}

void WindowCorrelation::CorrelateMaskedWindow(int row, int col,
                                              CorrelationTile* tile) {
  RowSums& sums = masked_sums_;
  for (auto* sum : sums.All()) {
    sum->assign(1, 0);
  }
  ForEachPixel(*tile, row, col, [&](size_t i) {
    sums.count[0] += 1;
    sums.image[0] += image_[i];
    sums.warped[0] += warped_[i];
    sums.image_squared[0] += image_[i] * image_[i];
    sums.warped_squared[0] += warped_[i] * warped_[i];
    sums.product[0] += image_[i] * warped_[i];
  });
  const size_t center = tile->Index(row, col);
  const float is_counted = 1;
  float by_image = 0;
  float by_warped = 0;
  float constant = 0;
  float curvature = 0;
  rows_.Correlate(1, sums, &is_counted,
                  {&tile->weights[center], &tile->energies[center], &by_image,
                   &by_warped, &constant, &curvature});
  if (!(tile->weights[center] > 0)) {
    return;
  }
  ForEachPixel(*tile, row, col, [&](size_t i) {
    masked_derivatives_[i] +=
        by_image * image_[i] + by_warped * warped_[i] + constant;
    masked_curvatures_[i] += curvature;
  });
}

// The others that count, one by one: pixels across the discontinuity are left
// out [Romanoni2019].
void WindowCorrelation::CorrelateMasked(int row, CorrelationTile* tile) {
  const int radius = options_.window_radius;
  for (int col = radius; col < tile->width - radius; ++col) {
    const size_t center = tile->Index(row, col);
    if (is_broken_[col] != 0 && tile->is_center[center] != 0 &&
        tile->is_valid[center] > 0) {
      CorrelateMaskedWindow(row, col, tile);
    }
  }
}

// Those of the pixels of a row, each from the windows that contain it. The sums
// run over the margins too, where there are no centres.
void WindowCorrelation::GatherDerivatives(int row, CorrelationTile* tile) {
  const size_t at = tile->Index(row, 0);
  const auto sum = [&](const std::vector<float>& of_windows,
                       std::vector<float>* to) {
    rows_.Sum(tile->width, of_windows.data() + at, to->data());
  };
  sum(windows_.by_image, &row_.by_image);
  sum(windows_.by_warped, &row_.by_warped);
  sum(windows_.constants, &row_.constants);
  sum(windows_.curvatures, &row_.curvatures);
  for (int col = 0; col < tile->width; ++col) {
    const size_t i = at + col;
    const float valid = tile->is_valid[i];
    tile->derivatives[i] =
        valid *
        (image_[i] * row_.by_image[col] + warped_[i] * row_.by_warped[col] +
         row_.constants[col] + masked_derivatives_[i]);
    tile->curvatures[i] =
        valid * (row_.curvatures[col] + masked_curvatures_[i]);
  }
}

void WindowCorrelation::Compute(float max_relative_depth,
                                CorrelationTile* tile) {
  const int radius = options_.window_radius;
  const int width = tile->width;
  max_relative_depth_ = max_relative_depth;
  SubtractMeans(*tile);
  windows_.Assign(tile->Index(tile->height + 2 * radius, 0));
  masked_derivatives_.assign(tile->image.size(), 0);
  masked_curvatures_.assign(tile->image.size(), 0);
  std::ranges::fill(tile->weights, 0.0F);
  std::ranges::fill(tile->energies, 0.0F);
  is_counted_.resize(width);
  lowest_.resize(width);
  highest_.resize(width);
  row_.Assign(width);
  for (int row = radius; row < tile->height - radius; ++row) {
    FindBroken(*tile, row);
    CorrelateRow(row, tile);
    CorrelateMasked(row, tile);
  }
  for (int row = 0; row < tile->height; ++row) {
    GatherDerivatives(row, tile);
  }
}

}  // namespace colmap_ext
