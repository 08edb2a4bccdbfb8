#include "tests/synthetic/photograph.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>

#include <gtest/gtest.h>

namespace colmap_ext::synthetic::photograph_test {

using Eigen::Vector3f;

constexpr int kSize = 90;  // px; no multiple of 8

CameraOptions Ideal() {
  CameraOptions options;
  options.sensor_noise = 0;
  options.photon_noise = 0;
  return options;
}

RadianceImage Picture(const std::function<Vector3f(int row, int col)>& color) {
  RadianceImage image{kSize, kSize, {}};
  for (int row = 0; row < kSize; ++row) {
    for (int col = 0; col < kSize; ++col) {
      image.pixels.push_back(color(row, col));
    }
  }
  return image;
}

RadianceImage Uniform() {
  return Picture([](int, int) { return Vector3f(0.2f, 0.4f, 0.8f); });
}

RadianceImage Stripes() {
  return Picture([](int, int col) {
    return Vector3f::Constant(col / 2 % 2 == 0 ? 0.4f : 0.6f);
  });
}

// Of the green values in the middle.
double Deviation(const ColorImage& image) {
  double sum = 0, squares = 0, count = 0;
  for (int row = 20; row < 60; ++row) {
    for (int col = 20; col < 60; ++col) {
      const double value = image.At(row, col)[1];
      sum += value;
      squares += value * value;
      ++count;
    }
  }
  return std::sqrt(squares / count - (sum / count) * (sum / count));
}

// Over pixels and colors.
int LargestDifference(const ColorImage& a, const ColorImage& b) {
  int largest = 0;
  for (size_t i = 0; i < a.pixels.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      largest = std::max(largest, std::abs(a.pixels[i][k] - b.pixels[i][k]));
    }
  }
  return largest;
}

TEST(Photograph, OfAnIdealCameraIsTheRadiance) {
  const ColorImage image = TakePhotograph(Uniform(), Ideal(), 1);
  ASSERT_EQ(image.pixels.size(), size_t{kSize * kSize});
  for (const Color& color : image.pixels) {
    EXPECT_EQ(color, (Color{51, 102, 204}));
  }
}

TEST(Photograph, OfOneColorStaysThatThroughMosaicSharpeningAndJpeg) {
  CameraOptions options = Ideal();
  options.defocus = 1;
  options.has_mosaic = true;
  options.sharpening = 1;
  options.jpeg_quality = 95;
  EXPECT_LE(LargestDifference(TakePhotograph(Uniform(), options, 1),
                              TakePhotograph(Uniform(), Ideal(), 1)),
            2);
}

TEST(Photograph, LacksLightInTheCorners) {
  CameraOptions options = Ideal();
  options.vignetting = 0.5;
  const ColorImage image = TakePhotograph(Uniform(), options, 1);
  EXPECT_EQ(image.At(kSize / 2, kSize / 2)[2], 204);
  EXPECT_NEAR(image.At(0, 0)[2], 102, 3);
  EXPECT_NEAR(image.At(kSize / 2, 0)[2], 153, 3);
}

TEST(Photograph, HasTheNoiseThatIsAskedFor) {
  CameraOptions options;
  options.sensor_noise = 3;
  options.photon_noise = 4;
  EXPECT_NEAR(Deviation(TakePhotograph(Uniform(), options, 1)),
              std::sqrt(9 + 16 * 0.4 + 1.0 / 12), 0.2);
}

TEST(Photograph, IsAnotherForEachHashAlone) {
  const auto take = [](uint64_t hash) {
    return TakePhotograph(Stripes(), CameraOptions(), hash).pixels;
  };
  EXPECT_EQ(take(1), take(1));
  EXPECT_NE(take(1), take(2));
}

TEST(Photograph, GetsSofterByDefocusAndCrisperBySharpening) {
  const auto contrast = [](double defocus, double sharpening) {
    CameraOptions options = Ideal();
    options.defocus = defocus;
    options.sharpening = sharpening;
    return Deviation(TakePhotograph(Stripes(), options, 1));
  };
  EXPECT_LT(contrast(1, 0), 0.8 * contrast(0, 0));
  EXPECT_GT(contrast(0, 0.5), 1.1 * contrast(0, 0));
}

// An interpolated value is the mean of measured ones.
TEST(Photograph, OfAMosaicHasNoiseThatNeighborsShare) {
  CameraOptions options;
  const double all = Deviation(TakePhotograph(Uniform(), options, 1));
  options.has_mosaic = true;
  const ColorImage image = TakePhotograph(Uniform(), options, 1);
  EXPECT_LT(Deviation(image), 0.9 * all);
  double products = 0, squares = 0;
  for (int row = 20; row < 60; ++row) {
    for (int col = 20; col < 60; ++col) {
      const double value = image.At(row, col)[1] - 102.0;
      products += value * (image.At(row, col + 1)[1] - 102.0);
      squares += value * value;
    }
  }
  EXPECT_GT(products, 0.2 * squares);
}

TEST(Photograph, LosesDetailByJpegTheMoreTheLowerItsQuality) {
  const RadianceImage waves = Picture([](int row, int col) {
    return Vector3f(0.5f + 0.3f * std::sin(0.9f * col),
                    0.5f + 0.3f * std::sin(0.7f * row), 0.5f);
  });
  const ColorImage ideal = TakePhotograph(waves, Ideal(), 1);
  const auto difference = [&](int quality) {
    CameraOptions options = Ideal();
    options.jpeg_quality = quality;
    return LargestDifference(TakePhotograph(waves, options, 1), ideal);
  };
  EXPECT_LE(difference(100), 3);
  EXPECT_GT(difference(60), difference(100));
  EXPECT_GT(difference(10), difference(60));
}

}  // namespace colmap_ext::synthetic::photograph_test
