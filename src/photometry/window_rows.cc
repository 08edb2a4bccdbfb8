#include "photometry/window_correlation.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

// Loops that have to become part of what calls them, see RunAt().
#define INLINE inline __attribute__((always_inline))
#define INLINE_BODY __attribute__((always_inline))

// Loops whose arrays do not overlap, which GCC forgets of inlined functions.
#if defined(__clang__)
#define INDEPENDENT
#else
#define INDEPENDENT _Pragma("GCC ivdep")
#endif

namespace colmap_ext {
namespace {

// term(0), ..., term(kCount - 1), combined in this order.
template <int kCount, typename Term, typename Combine>
INLINE float Fold(const Term& term, const Combine& combine) {
  if constexpr (kCount == 1) {
    return term(0);
  } else {
    return combine(Fold<kCount - 1>(term, combine), term(kCount - 1));
  }
}

template <int kCount, typename Term>
INLINE float SumOf(const Term& term) {
  return Fold<kCount>(term, [](float a, float b) INLINE_BODY { return a + b; });
}

constexpr auto kMin = [](float a, float b)
                          INLINE_BODY { return std::min(a, b); };
constexpr auto kMax = [](float a, float b)
                          INLINE_BODY { return std::max(a, b); };

// Sums of the windows' columns, [6][stride].
template <int kSide>
INLINE void SumColumns(int width, const float* __restrict image,
                       const float* __restrict warped,
                       const float* __restrict is_valid, int stride,
                       float* __restrict columns) {
  INDEPENDENT
  for (int i = 0; i < width; ++i) {
    const auto in = [&](const float* plane) INLINE_BODY {
      return [=](int k) INLINE_BODY { return plane[k * width + i]; };
    };
    const auto product = [&](const float* a, const float* b) INLINE_BODY {
      return [=](int k)
                 INLINE_BODY { return a[k * width + i] * b[k * width + i]; };
    };
    columns[i] = SumOf<kSide>(in(is_valid));
    columns[stride + i] = SumOf<kSide>(in(image));
    columns[2 * stride + i] = SumOf<kSide>(in(warped));
    columns[3 * stride + i] = SumOf<kSide>(product(image, image));
    columns[4 * stride + i] = SumOf<kSide>(product(warped, warped));
    columns[5 * stride + i] = SumOf<kSide>(product(image, warped));
  }
}

// Sums of kSide columns beside each other.
template <int kSide>
INLINE void SumAlongRow(int width, const float* __restrict columns,
                        float* __restrict sums) {
  INDEPENDENT
  for (int i = 0; i < width; ++i) {
    sums[i] = SumOf<kSide>([&](int k) INLINE_BODY { return columns[i + k]; });
  }
}

// Calls body.operator()<2 radius + 1>().
// \pre kRadius <= radius <= 7
template <int kRadius = 1, typename Body>
INLINE void WithSide(int radius, const Body& body) {
  if constexpr (kRadius < 7) {
    if (radius != kRadius) {
      return WithSide<kRadius + 1>(radius, body);
    }
  }
  body.template operator()<2 * kRadius + 1>();
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
    const PhotometricOptions& options, int width, const float* __restrict count,
    const float* __restrict image, const float* __restrict warped,
    const float* __restrict image_squared,
    const float* __restrict warped_squared, const float* __restrict product,
    const float* __restrict is_counted, float* __restrict weights,
    float* __restrict znccs, float* __restrict by_image,
    float* __restrict by_warped, float* __restrict by_weight,
    float* __restrict curvatures) {
  // More than half of the window has to be seen: the centre's surface is the
  // larger part of it.
  constexpr float kMinShare = 0.5F;
  const int side = 2 * options.window_radius + 1;
  const float min_count = kMinShare * static_cast<float>(side * side);
  const auto noise = static_cast<float>(options.noise_variance);
  const auto saturation = static_cast<float>(1 + options.residual_floor);
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
        (is_counted[i] * count[i] > min_count) & (smaller > kMinVariance);
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

float* WindowRows::Columns(int num_rows, int width, float margin) {
  columns_.assign(static_cast<size_t>(num_rows) * (width + 2 * radius_),
                  margin);
  return columns_.data() + radius_;
}

void WindowRows::Sum(int width, const float* image, const float* warped,
                     const float* is_valid, RowSums* sums) {
  for (auto* of_windows : sums->All()) {
    of_windows->resize(width);
  }
  const int stride = width + 2 * radius_;
  float* columns = Columns(6, width, 0);
  const auto sum = [&]<int kSide>() INLINE_BODY {
    SumColumns<kSide>(width, image, warped, is_valid, stride, columns);
    const float* row = columns - kSide / 2;
    for (auto* of_windows : sums->All()) {
      SumAlongRow<kSide>(width, row, of_windows->data());
      row += stride;
    }
  };
  RunAt(level_, [&]() INLINE_BODY { WithSide(radius_, sum); });
}

void WindowRows::Sum(int width, const float* values, float* sums) {
  float* columns = Columns(1, width, 0);
  const auto sum = [&]<int kSide>() INLINE_BODY {
    INDEPENDENT
    for (int i = 0; i < width; ++i) {
      columns[i] = SumOf<kSide>(
          [&](int k) INLINE_BODY { return values[k * width + i]; });
    }
    SumAlongRow<kSide>(width, columns - kSide / 2, sums);
  };
  RunAt(level_, [&]() INLINE_BODY { WithSide(radius_, sum); });
}

void WindowRows::FindRange(int width, const float* values,
                           const float* is_valid, float* lowest,
                           float* highest) {
  constexpr float kFar = std::numeric_limits<float>::max();
  const int stride = width + 2 * radius_;
  float* low = Columns(2, width, kFar);
  float* high = low + stride;
  std::fill_n(high - radius_, stride, -kFar);
  const float* center = values + ptrdiff_t{radius_} * width;
  const auto find = [&]<int kSide>() INLINE_BODY {
    constexpr int kRadius = kSide / 2;
    INDEPENDENT
    for (int i = 0; i < width; ++i) {
      const auto valid = [&](float otherwise) INLINE_BODY {
        return [=](int k) INLINE_BODY {
          const int at = k * width + i;
          return is_valid[at] > 0 ? values[at] : otherwise;
        };
      };
      low[i] = Fold<kSide>(valid(kFar), kMin);
      high[i] = Fold<kSide>(valid(-kFar), kMax);
    }
    INDEPENDENT
    for (int i = 0; i < width; ++i) {
      const auto beside = [&](const float* of_columns) INLINE_BODY {
        return [=](int k) INLINE_BODY { return of_columns[i - kRadius + k]; };
      };
      lowest[i] = std::min(center[i], Fold<kSide>(beside(low), kMin));
      highest[i] = std::max(center[i], Fold<kSide>(beside(high), kMax));
    }
  };
  RunAt(level_, [&]() INLINE_BODY { WithSide(radius_, find); });
}

void WindowRows::Correlate(int width, const RowSums& sums,
                           const float* is_counted,
                           const WindowRow& row) const {
  RunAt(level_, [&]() INLINE_BODY {
    FindZnccs(options_, width, sums.count.data(), sums.image.data(),
              sums.warped.data(), sums.image_squared.data(),
              sums.warped_squared.data(), sums.product.data(), is_counted,
              row.weights, row.energies, row.by_image, row.by_warped,
              row.constants, row.curvatures);
  });
  const double s = static_cast<float>(1 + options_.residual_floor);
  for (int i = 0; i < width; ++i) {
    row.energies[i] =
        row.weights[i] > 0
            ? static_cast<float>(s * std::log(1 - row.energies[i] / s))
            : 0;
  }
  RunAt(level_, [&]() INLINE_BODY {
    Finish(width, sums.count.data(), sums.image.data(), sums.warped.data(),
           row.weights, row.energies, row.by_image, row.by_warped,
           row.constants);
  });
}

}  // namespace colmap_ext
