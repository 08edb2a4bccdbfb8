#include "photometry/window_rows.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

// Loops that have to become part of what calls them, see RunAt().
#define INLINE inline __attribute__((always_inline))

// Loops whose arrays do not overlap, which GCC forgets of inlined functions.
#if defined(__clang__)
#define INDEPENDENT
#else
#define INDEPENDENT _Pragma("GCC ivdep")
#endif

namespace colmap_ext {

namespace {

INLINE void Add(int size, const float* __restrict from, float* __restrict to) {
  INDEPENDENT
  for (int i = 0; i < size; ++i) {
    to[i] += from[i];
  }
}

// Sums of 2 radius + 1 values beside each other.
INLINE void SumAlongRow(int width, int radius, const float* __restrict from,
                        float* __restrict to) {
  std::fill_n(to, width, 0.0F);
  for (int k = -radius; k <= radius; ++k) {
    const int first = std::max(-k, 0);
    Add(width - std::max(k, 0) - first, from + first + k, to + first);
  }
}

// Adds a row of pixels to the sums of columns.
INLINE void AddPixels(int width, const float* __restrict image,
                      const float* __restrict warped,
                      const float* __restrict is_valid,
                      float* __restrict columns) {
  float* __restrict images = columns + width;
  float* __restrict warpeds = columns + 2 * width;
  float* __restrict images_squared = columns + 3 * width;
  float* __restrict warpeds_squared = columns + 4 * width;
  float* __restrict products = columns + 5 * width;
  INDEPENDENT
  for (int i = 0; i < width; ++i) {
    columns[i] += is_valid[i];
    images[i] += image[i];
    warpeds[i] += warped[i];
    images_squared[i] += image[i] * image[i];
    warpeds_squared[i] += warped[i] * warped[i];
    products[i] += image[i] * warped[i];
  }
}

INLINE void Widen(int size, const float* __restrict values,
                  const float* __restrict is_valid, float* __restrict lowest,
                  float* __restrict highest) {
  constexpr float kMax = std::numeric_limits<float>::max();
  INDEPENDENT
  for (int i = 0; i < size; ++i) {
    lowest[i] = std::min(lowest[i], is_valid[i] > 0 ? values[i] : kMax);
    highest[i] = std::max(highest[i], is_valid[i] > 0 ? values[i] : -kMax);
  }
}

// With N pixels, means I' and J', variances A and B, covariance C:
//   w c(ZNCC), c(Z) = s log(1 - Z / s), dc / dZ = -s / (s - Z)
//   ZNCC = C / sqrt(A B)
//   dZNCC / dJ(y) = ((I(y) - I') / sqrt(A B) - ZNCC (J(y) - J') / B) / N
//   w = m / (m + e), m = min(A, B)
//   dw / dJ(y) = e / (m + e)^2 * 2 (J(y) - J') / N if B < A, else 0.
// 1 - ZNCC is half the squared distance of I and J, normalised. Gauss-Newton's
// second derivative is the square of that distance's first one, 1 / (N B),
// times w |dc / dZ|: without what couples the pixels of a window, and without
// the derivative of the normalisation.
//
// Leaves ZNCC in `energies`, N dZNCC w dc / dZ by J - J' in `by_warped`, and
// N dw by J - J' in `constants`.
INLINE void FindZnccs(
    const WindowConstants& of_all, int width, const float* __restrict count,
    const float* __restrict image, const float* __restrict warped,
    const float* __restrict image_squared,
    const float* __restrict warped_squared, const float* __restrict product,
    const float* __restrict is_counted, float* __restrict weights,
    float* __restrict znccs, float* __restrict by_image,
    float* __restrict by_warped, float* __restrict by_weight,
    float* __restrict curvatures) {
  const float min_count = of_all.min_count;
  const float min_variance = of_all.min_variance;
  const float noise = of_all.noise_variance;
  const float saturation = of_all.saturation;
  INDEPENDENT
  for (int i = 0; i < width; ++i) {
    const float scale = 1 / std::max(count[i], 1.0F);
    const float mean_image = image[i] * scale;
    const float mean_warped = warped[i] * scale;
    const float a =
        std::max(image_squared[i] * scale - mean_image * mean_image, 0.0F);
    const float b =
        std::max(warped_squared[i] * scale - mean_warped * mean_warped, 0.0F);
    const float covariance = product[i] * scale - mean_image * mean_warped;
    const float smaller = std::min(a, b);
    const bool is_good =
        (is_counted[i] * count[i] > min_count) & (smaller > min_variance);
    const float safe_b = is_good ? b : 1.0F;
    const float root = std::sqrt(is_good ? a * b : 1.0F);
    // Rounding can leave the range.
    const float zncc = std::min(std::max(covariance / root, -1.0F), 1.0F);
    const float noisy = smaller + noise;
    const float weight = is_good ? smaller / noisy : 0.0F;
    const float by_b = b < a ? 2 * noise / (noisy * noisy) : 0.0F;
    const float slope = saturation / (saturation - zncc);
    weights[i] = weight;
    znccs[i] = zncc;
    by_image[i] = -weight * slope * scale / root;
    by_warped[i] = zncc * weight * slope / safe_b;
    by_weight[i] = is_good ? by_b : 0.0F;
    curvatures[i] = weight * slope * scale / safe_b;
  }
}

// The rest, with c in `energies` in place of ZNCC.
INLINE void Finish(int width, const float* __restrict count,
                   const float* __restrict image,
                   const float* __restrict warped,
                   const float* __restrict weights, float* __restrict energies,
                   const float* __restrict by_image,
                   float* __restrict by_warped, float* __restrict constants) {
  INDEPENDENT
  for (int i = 0; i < width; ++i) {
    const float scale = 1 / std::max(count[i], 1.0F);
    const float by = scale * (by_warped[i] + energies[i] * constants[i]);
    energies[i] *= weights[i];
    by_warped[i] = by;
    constants[i] = -by_image[i] * (image[i] * scale) - by * (warped[i] * scale);
  }
}

}  // namespace

void WindowRows::Sum(int width, const float* image, const float* warped,
                     const float* is_valid, RowSums* sums) {
  columns_.assign(size_t{6} * width, 0);
  sums->Resize(width);
  RunAt(
      level_, [&]() __attribute__((always_inline)) {
        float* columns = columns_.data();
        for (int row = 0; row <= 2 * radius_; ++row) {
          const ptrdiff_t at = ptrdiff_t{row} * width;
          AddPixels(width, image + at, warped + at, is_valid + at, columns);
        }
        for (auto* sum :
             {&sums->count, &sums->image, &sums->warped, &sums->image_squared,
              &sums->warped_squared, &sums->product}) {
          SumAlongRow(width, radius_, columns, sum->data());
          columns += width;
        }
      });
}

void WindowRows::Sum(int width, const float* values, float* sums) {
  columns_.assign(width, 0);
  RunAt(
      level_, [&]() __attribute__((always_inline)) {
        for (int row = 0; row <= 2 * radius_; ++row) {
          Add(width, values + ptrdiff_t{row} * width, columns_.data());
        }
        SumAlongRow(width, radius_, columns_.data(), sums);
      });
}

void WindowRows::FindRange(int width, const float* values,
                           const float* is_valid, float* lowest,
                           float* highest) {
  columns_.resize(size_t{2} * width);
  const float* center = values + ptrdiff_t{radius_} * width;
  std::copy_n(center, width, lowest);
  std::copy_n(center, width, highest);
  RunAt(
      level_, [&]() __attribute__((always_inline)) {
        constexpr float kMax = std::numeric_limits<float>::max();
        float* __restrict low = columns_.data();
        float* __restrict high = low + width;
        std::fill_n(low, width, kMax);
        std::fill_n(high, width, -kMax);
        for (int row = 0; row <= 2 * radius_; ++row) {
          const ptrdiff_t at = ptrdiff_t{row} * width;
          Widen(width, values + at, is_valid + at, low, high);
        }
        for (int k = -radius_; k <= radius_; ++k) {
          for (int i = std::max(-k, 0); i < width - std::max(k, 0); ++i) {
            lowest[i] = std::min(lowest[i], low[i + k]);
            highest[i] = std::max(highest[i], high[i + k]);
          }
        }
      });
}

void WindowRows::Correlate(const WindowConstants& constants, int width,
                           const RowSums& sums, const float* is_counted,
                           const WindowRow& row) const {
  RunAt(
      level_, [&]() __attribute__((always_inline)) {
        FindZnccs(constants, width, sums.count.data(), sums.image.data(),
                  sums.warped.data(), sums.image_squared.data(),
                  sums.warped_squared.data(), sums.product.data(), is_counted,
                  row.weights, row.energies, row.by_image, row.by_warped,
                  row.constants, row.curvatures);
      });
  const double s = constants.saturation;
  for (int i = 0; i < width; ++i) {
    row.energies[i] =
        row.weights[i] > 0
            ? static_cast<float>(s * std::log(1 - row.energies[i] / s))
            : 0;
  }
  RunAt(
      level_, [&]() __attribute__((always_inline)) {
        Finish(width, sums.count.data(), sums.image.data(), sums.warped.data(),
               row.weights, row.energies, row.by_image, row.by_warped,
               row.constants);
      });
}

}  // namespace colmap_ext
