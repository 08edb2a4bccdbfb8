#include "photometry/window_correlation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include <gtest/gtest.h>

#include "tests/random.h"
#include "tests/raster/pixels.h"

namespace colmap_ext::window_correlation_test {

// All pixels valid and of one depth, but the margins centres; images at random.
CorrelationTile RandomTile(int width, int height, int radius, Random* random) {
  CorrelationTile tile;
  tile.Resize(width, height);
  for (size_t i = 0; i < tile.image.size(); ++i) {
    tile.image[i] = static_cast<float>(random->Below(256));
    tile.warped[i] =
        0.6f * tile.image[i] + static_cast<float>(100 * random->Unit());
    tile.is_valid[i] = 1;
    tile.inverse_depths[i] = 1;
    const int row = static_cast<int>(i) / width;
    const int col = static_cast<int>(i) % width;
    tile.is_center[i] = row >= radius && row < height - radius &&
                        col >= radius && col < width - radius;
  }
  return tile;
}

// With holes, in two depths, not all of it centres.
CorrelationTile RaggedTile(int width, int height, int radius, Random* random) {
  CorrelationTile tile = RandomTile(width, height, radius, random);
  for (int row = 0; row < height; ++row) {
    for (int col = 0; col < width; ++col) {
      const size_t i = tile.Index(row, col);
      tile.is_valid[i] = random->Chance(0.8) ? 1 : 0;
      tile.inverse_depths[i] = 3 * col > width + 2 * row ? 2.0f : 1.0f;
      tile.is_center[i] = tile.is_center[i] != 0 && random->Chance(0.9);
    }
  }
  return tile;
}

struct Case {
  PhotometricOptions options;
  float max_relative_depth = std::numeric_limits<float>::max();
  CorrelationTile tile;
};

// From the definitions, in double.
struct DirectWindow {
  std::vector<size_t> pixels;
  double a = 0;  // variances
  double b = 0;
  double zncc = 0;
  double weight = 0;
  double energy = 0;
};

DirectWindow Correlate(const Case& ragged, const std::vector<double>& warped,
                       int row, int col) {
  const CorrelationTile& tile = ragged.tile;
  const int radius = ragged.options.window_radius;
  const double depth = tile.inverse_depths[tile.Index(row, col)];
  DirectWindow window;
  for (int y = row - radius; y <= row + radius; ++y) {
    for (int x = col - radius; x <= col + radius; ++x) {
      const size_t i = tile.Index(y, x);
      if (tile.is_valid[i] > 0 && std::abs(tile.inverse_depths[i] - depth) <=
                                      ragged.max_relative_depth * depth) {
        window.pixels.push_back(i);
      }
    }
  }
  const auto count = static_cast<double>(window.pixels.size());
  const int side = 2 * radius + 1;
  if (2 * window.pixels.size() <= static_cast<size_t>(side * side)) {
    return window;
  }
  double mean_image = 0;
  double mean_warped = 0;
  for (const size_t i : window.pixels) {
    mean_image += tile.image[i] / count;
    mean_warped += warped[i] / count;
  }
  double covariance = 0;
  for (const size_t i : window.pixels) {
    const double image = tile.image[i] - mean_image;
    window.a += image * image / count;
    window.b += (warped[i] - mean_warped) * (warped[i] - mean_warped) / count;
    covariance += image * (warped[i] - mean_warped) / count;
  }
  const double smaller = std::min(window.a, window.b);
  if (smaller > kMinVariance) {
    const double s = 1 + ragged.options.residual_floor;
    window.zncc = covariance / std::sqrt(window.a * window.b);
    window.weight = smaller / (smaller + ragged.options.noise_variance);
    window.energy = window.weight * s * std::log(1 - window.zncc / s);
  }
  return window;
}

// Calls function(i, window) for all windows that count.
template <typename Function>
void ForEachWindow(const Case& ragged, const std::vector<double>& warped,
                   const Function& function) {
  ForEachPixel(ragged.tile, [&](int row, int col) {
    const size_t i = ragged.tile.Index(row, col);
    if (ragged.tile.is_center[i] != 0 && ragged.tile.is_valid[i] > 0) {
      function(i, Correlate(ragged, warped, row, col));
    }
  });
}

double DirectEnergy(const Case& ragged, const std::vector<double>& warped) {
  double energy = 0;
  ForEachWindow(ragged, warped, [&](size_t, const DirectWindow& window) {
    energy += window.energy;
  });
  return energy;
}

double Sum(const std::vector<float>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

// Ragged tiles with all sizes of windows, with and without masks.
std::vector<Case> RaggedCases() {
  Random random(1);
  std::vector<Case> cases;
  for (const int radius : {1, 2, 3}) {
    for (const bool is_masking : {false, true}) {
      Case ragged;
      ragged.options.window_radius = radius;
      ragged.options.occlusion_masking = is_masking;
      ragged.options.noise_variance = 200;
      if (is_masking) {
        ragged.max_relative_depth = 0.1f;
      }
      ragged.tile = RaggedTile(17, 14, radius, &random);
      cases.push_back(std::move(ragged));
    }
  }
  return cases;
}

TEST(WindowCorrelation, AgreesWithADirectComputation) {
  for (Case& ragged : RaggedCases()) {
    CorrelationTile& tile = ragged.tile;
    WindowCorrelation(ragged.options).Compute(ragged.max_relative_depth, &tile);
    std::vector<double> weights(tile.image.size(), 0);
    std::vector<double> energies(tile.image.size(), 0);
    std::vector<double> curvatures(tile.image.size(), 0);
    const double s = 1 + ragged.options.residual_floor;
    ForEachWindow(ragged, {tile.warped.begin(), tile.warped.end()},
                  [&](size_t center, const DirectWindow& window) {
                    weights[center] = window.weight;
                    energies[center] = window.energy;
                    for (const size_t i : window.pixels) {
                      curvatures[i] +=
                          window.weight == 0
                              ? 0
                              : window.weight * s / (s - window.zncc) /
                                    (static_cast<double>(window.pixels.size()) *
                                     window.b);
                    }
                  });
    EXPECT_GT(std::ranges::count_if(weights,
                                    [](double weight) { return weight > 0.5; }),
              20);
    for (size_t i = 0; i < weights.size(); ++i) {
      EXPECT_NEAR(tile.weights[i], weights[i], 1e-4);
      EXPECT_NEAR(tile.energies[i], energies[i], 1e-3);
      EXPECT_NEAR(tile.curvatures[i], curvatures[i],
                  1e-3 * (1e-3 + curvatures[i]));
    }
  }
}

TEST(WindowCorrelation, IsTheSameWhateverTheProcessorsVectors) {
  if (BestSimdLevel() == SimdLevel::kBaseline) {
    GTEST_SKIP() << "this processor has no wider vectors: NOT TESTED";
  }
  for (Case& ragged : RaggedCases()) {
    CorrelationTile& narrow = ragged.tile;
    CorrelationTile wide = narrow;
    WindowCorrelation(ragged.options, SimdLevel::kBaseline)
        .Compute(ragged.max_relative_depth, &narrow);
    WindowCorrelation(ragged.options, BestSimdLevel())
        .Compute(ragged.max_relative_depth, &wide);
    EXPECT_EQ(narrow.weights, wide.weights);
    EXPECT_EQ(narrow.energies, wide.energies);
    EXPECT_EQ(narrow.derivatives, wide.derivatives);
    EXPECT_EQ(narrow.curvatures, wide.curvatures);
  }
}

TEST(WindowCorrelation, DerivativesAreThoseOfFiniteDifferences) {
  constexpr double kStep = 1e-3;
  for (Case& ragged : RaggedCases()) {
    CorrelationTile& tile = ragged.tile;
    WindowCorrelation(ragged.options).Compute(ragged.max_relative_depth, &tile);
    double largest = 0;
    for (const float derivative : tile.derivatives) {
      largest = std::max<double>(largest, std::abs(derivative));
    }
    EXPECT_GT(largest, 0);
    std::vector<double> warped(tile.warped.begin(), tile.warped.end());
    for (size_t i = 0; i < warped.size(); ++i) {
      const double value = warped[i];
      warped[i] = value + kStep;
      const double above = DirectEnergy(ragged, warped);
      warped[i] = value - kStep;
      const double below = DirectEnergy(ragged, warped);
      warped[i] = value;
      EXPECT_NEAR(tile.derivatives[i], (above - below) / (2 * kStep),
                  1e-3 * largest);
    }
  }
}

TEST(WindowCorrelation, IsOneWithTheImageItselfWhateverItsExposure) {
  Random random(2);
  const PhotometricOptions options;
  const double s = 1 + options.residual_floor;
  for (const float gain : {1.0f, 0.3f, 2.5f, -1.0f, -0.5f}) {
    for (const float offset : {0.0f, 70.0f}) {
      CorrelationTile tile = RandomTile(20, 15, options.window_radius, &random);
      for (size_t i = 0; i < tile.image.size(); ++i) {
        tile.warped[i] = gain * tile.image[i] + offset;
      }
      WindowCorrelation(options).Compute(1, &tile);
      const double cost = s * std::log(1 - (gain > 0 ? 1 : -1) / s);
      for (size_t i = 0; i < tile.image.size(); ++i) {
        EXPECT_EQ(tile.weights[i] > 0.9, tile.is_center[i] != 0);
        EXPECT_NEAR(tile.energies[i], tile.weights[i] * cost, 1e-3);
      }
    }
  }
}

TEST(WindowCorrelation, GivesFlatWindowsNoWeight) {
  Random random(4);
  const PhotometricOptions options;
  CorrelationTile tile = RandomTile(20, 15, options.window_radius, &random);
  // What is left of variance is rounding.
  const auto flat = [&](size_t i) {
    return 100 + 1e-2f * static_cast<float>(i % 7);
  };
  for (const bool is_warped : {false, true}) {
    CorrelationTile changed = tile;
    for (size_t i = 0; i < tile.image.size(); ++i) {
      (is_warped ? changed.warped : changed.image)[i] = flat(i);
    }
    WindowCorrelation(options).Compute(1, &changed);
    const std::vector<float> zero(tile.image.size(), 0);
    EXPECT_EQ(changed.weights, zero);
    EXPECT_EQ(changed.energies, zero);
    EXPECT_EQ(changed.derivatives, zero);
    EXPECT_EQ(changed.curvatures, zero);
  }
}

TEST(WindowCorrelation, WantsHalfOfAWindowValid) {
  Random random(6);
  const PhotometricOptions options;
  for (const int num_valid : {12, 13}) {
    CorrelationTile tile = RandomTile(5, 5, options.window_radius, &random);
    for (size_t i = 0; i < tile.image.size(); ++i) {
      tile.is_valid[i] = i == 12 || i >= 26u - num_valid ? 1 : 0;
    }
    EXPECT_EQ(Sum(tile.is_valid), num_valid);
    WindowCorrelation(options).Compute(1, &tile);
    EXPECT_EQ(tile.weights[12] > 0, num_valid > 12);
  }
}

TEST(WindowCorrelation, DoesNotDependOnHowTheImageIsCutInTiles) {
  constexpr int kRadius = 2;
  Random random(9);
  const PhotometricOptions options;
  const CorrelationTile whole = RaggedTile(30, 14, kRadius, &random);
  const auto cut = [&](int first_col, int last_col) {
    CorrelationTile tile;
    tile.Resize(last_col - first_col + 1 + 2 * kRadius, whole.height);
    ForEachPixel(tile, [&](int row, int col) {
      const size_t to = tile.Index(row, col);
      const size_t from = whole.Index(row, col + first_col - kRadius);
      tile.image[to] = whole.image[from];
      tile.warped[to] = whole.warped[from];
      tile.is_valid[to] = whole.is_valid[from];
      tile.inverse_depths[to] = whole.inverse_depths[from];
      tile.is_center[to] = col >= kRadius && col < tile.width - kRadius
                               ? whole.is_center[from]
                               : 0;
    });
    WindowCorrelation(options).Compute(0.1f, &tile);
    return tile;
  };
  CorrelationTile expected = whole;
  WindowCorrelation(options).Compute(0.1f, &expected);
  std::vector<double> energies(whole.image.size(), 0);
  std::vector<double> derivatives(whole.image.size(), 0);
  for (const auto& [first, last] : {std::pair(2, 12), {13, 27}}) {
    const CorrelationTile tile = cut(first, last);
    ForEachPixel(tile, [&](int row, int col) {
      const size_t to = whole.Index(row, col + first - kRadius);
      energies[to] += tile.energies[tile.Index(row, col)];
      derivatives[to] += tile.derivatives[tile.Index(row, col)];
    });
  }
  for (size_t i = 0; i < energies.size(); ++i) {
    EXPECT_NEAR(energies[i], expected.energies[i], 1e-4);
    EXPECT_NEAR(derivatives[i], expected.derivatives[i], 1e-5);
  }
}

TEST(CorrelationTile, FindsWhatTheWindowsReach) {
  Random random(5);
  for (const int radius : {1, 2, 3}) {
    CorrelationTile tile;
    tile.Resize(23, 17);
    std::ranges::fill(tile.is_center, 0);
    for (int row = radius; row < tile.height - radius; ++row) {
      for (int col = radius; col < tile.width - radius; ++col) {
        tile.is_center[tile.Index(row, col)] = random.Below(40) == 0 ? 1 : 0;
      }
    }
    tile.FindReached(radius);
    ForEachPixel(tile, [&](int row, int col) {
      bool is_reached = false;
      for (int y = 0; y < tile.height; ++y) {
        for (int x = 0; x < tile.width; ++x) {
          is_reached |= tile.is_center[tile.Index(y, x)] != 0 &&
                        std::abs(y - row) <= radius &&
                        std::abs(x - col) <= radius;
        }
      }
      EXPECT_EQ(tile.is_reached[tile.Index(row, col)], is_reached ? 1 : 0);
    });
  }
}

// The pixels of a plane that leans by less than 76 degrees belong together.
TEST(MaxRelativeDepth, IsThatOfSteepPlanes) {
  const View view{"", 0, 0, 800, 1000};
  for (const int radius : {1, 2, 5}) {
    PhotometricOptions options;
    options.window_radius = radius;
    const double limit = MaxRelativeDepth(options, view, options.window_radius);
    for (const double degrees : {70.0, 75.5, 76.5, 80.0}) {
      const double slope = std::tan(degrees * std::numbers::pi / 180);
      // With z = 1 + slope x and u = fx x / z, 1 / z = 1 - slope u / fx.
      const double difference = slope * radius / view.fx;
      EXPECT_EQ(difference < limit, degrees < 76) << degrees;
    }
    options.occlusion_masking = false;
    EXPECT_EQ(MaxRelativeDepth(options, view, options.window_radius),
              std::numeric_limits<float>::max());
  }
}

}  // namespace colmap_ext::window_correlation_test
