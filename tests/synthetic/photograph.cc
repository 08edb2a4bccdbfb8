#include "tests/synthetic/photograph.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <tbb/parallel_for.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "tests/synthetic/noise.h"

namespace colmap_ext::synthetic {
namespace {

// All pictures here are CV_32FC3, red, green and blue, 0 ... 255.

cv::Mat Blurred(const cv::Mat& picture, double deviation) {
  cv::Mat blurred;
  cv::GaussianBlur(picture, blurred, {}, deviation, deviation,
                   cv::BORDER_REPLICATE);
  return blurred;
}

void Darken(double vignetting, cv::Mat* picture) {
  const cv::Vec2d center(0.5 * picture->cols, 0.5 * picture->rows);
  for (int row = 0; row < picture->rows; ++row) {
    for (int col = 0; col < picture->cols; ++col) {
      const cv::Vec2d offset = cv::Vec2d(col + 0.5, row + 0.5) - center;
      picture->at<cv::Vec3f>(row, col) *= static_cast<float>(
          1 - vignetting * offset.dot(offset) / center.dot(center));
    }
  }
}

void AddNoise(const CameraOptions& options, uint64_t hash, cv::Mat* picture) {
  tbb::parallel_for(0, picture->rows, [&](int row) {
    for (int col = 0; col < picture->cols; ++col) {
      const size_t index = static_cast<size_t>(row) * picture->cols + col;
      const uint64_t of_pixel = Hash(hash, index);
      auto& pixel = picture->at<cv::Vec3f>(row, col);
      for (int i = 0; i < 3; ++i) {
        const double ideal = std::clamp(pixel[i], 0.0f, 255.0f);
        const double deviation =
            std::hypot(options.sensor_noise,
                       options.photon_noise * std::sqrt(ideal / 255));
        pixel[i] =
            static_cast<float>(ideal + deviation * Gaussian(Hash(of_pixel, i)));
      }
    }
  });
}

// Keeps red, green or blue of each pixel, and interpolates the others.
cv::Mat Demosaiced(const cv::Mat& picture) {
  constexpr float kScale = 128;  // to 16 bits, above an offset for the noise
  constexpr float kOffset = 64;
  cv::Mat mosaic(picture.size(), CV_16U);
  for (int row = 0; row < picture.rows; ++row) {
    for (int col = 0; col < picture.cols; ++col) {
      mosaic.at<uint16_t>(row, col) = cv::saturate_cast<uint16_t>(
          kScale *
          (picture.at<cv::Vec3f>(row, col)[row % 2 + col % 2] + kOffset));
    }
  }
  // OpenCV names the pattern by the second row's second and third pixels.
  cv::Mat colors;
  cv::cvtColor(mosaic, colors, cv::COLOR_BayerBG2RGB);
  colors.convertTo(colors, CV_32F, 1 / kScale, -kOffset);
  return colors;
}

// Quantizes the cosine transform of each block of 8 x 8 pixels by the tables of
// JPEG (ITU-T T.81, annex K), scaled as by the Independent JPEG Group.
void Compress(const std::array<uint8_t, 64>& table, int quality,
              cv::Mat* channel) {
  const int scale = quality < 50 ? 5000 / quality : 200 - 2 * quality;
  for (int row = 0; row < channel->rows; row += 8) {
    for (int col = 0; col < channel->cols; col += 8) {
      cv::Mat block = (*channel)(cv::Rect(col, row, 8, 8));
      cv::Mat waves;
      cv::dct(block - 128, waves);
      for (int i = 0; i < 64; ++i) {
        const auto step = static_cast<float>(
            std::clamp((table[i] * scale + 50) / 100, 1, 255));
        float& wave = waves.at<float>(i / 8, i % 8);
        wave = step * std::round(wave / step);
      }
      cv::idct(waves, waves);
      waves += 128;
      waves.copyTo(block);
    }
  }
}

// Chroma at full resolution.
void CompressAsJpeg(int quality, cv::Mat* picture) {
  constexpr std::array<uint8_t, 64> kLuma = {
      16, 11, 10, 16, 24,  40,  51,  61,  12, 12, 14, 19, 26,  58,  60,  55,
      14, 13, 16, 24, 40,  57,  69,  56,  14, 17, 22, 29, 51,  87,  80,  62,
      18, 22, 37, 56, 68,  109, 103, 77,  24, 35, 55, 64, 81,  104, 113, 92,
      49, 64, 78, 87, 103, 121, 120, 101, 72, 92, 95, 98, 112, 100, 103, 99};
  std::array<uint8_t, 64> chroma;
  chroma.fill(99);
  constexpr std::array<uint8_t, 16> kLow = {17, 18, 24, 47, 18, 21, 26, 66,
                                            24, 26, 56, 99, 47, 66, 99, 99};
  for (size_t i = 0; i < kLow.size(); ++i) {
    chroma[8 * (i / 4) + i % 4] = kLow[i];
  }
  const cv::Size size = picture->size();
  cv::Mat padded;
  cv::copyMakeBorder(*picture, padded, 0, (8 - size.height % 8) % 8, 0,
                     (8 - size.width % 8) % 8, cv::BORDER_REPLICATE);
  cv::cvtColor(padded / 255, padded, cv::COLOR_RGB2YCrCb);
  std::array<cv::Mat, 3> channels;
  cv::split(255 * padded, channels.data());
  for (size_t i = 0; i < 3; ++i) {
    Compress(i == 0 ? kLuma : chroma, quality, &channels[i]);
  }
  cv::merge(channels.data(), 3, padded);
  cv::cvtColor(padded / 255, padded, cv::COLOR_YCrCb2RGB);
  *picture = 255 * padded(cv::Rect({}, size));
}

}  // namespace

ColorImage TakePhotograph(const RadianceImage& radiance,
                          const CameraOptions& options, uint64_t hash) {
  cv::Mat picture(radiance.height, radiance.width, CV_32FC3);
  for (int row = 0; row < radiance.height; ++row) {
    for (int col = 0; col < radiance.width; ++col) {
      const Eigen::Vector3f& color = radiance.At(row, col);
      picture.at<cv::Vec3f>(row, col) =
          255 * cv::Vec3f(color[0], color[1], color[2]);
    }
  }
  const auto factor = [hash](uint64_t use) {
    return 0.5 + Uniform(Hash(hash, 0x63616d, use));
  };
  if (options.defocus > 0) {
    picture = Blurred(picture, options.defocus * factor(0));
  }
  Darken(options.vignetting, &picture);
  AddNoise(options, hash, &picture);
  if (options.has_mosaic) {
    picture = Demosaiced(picture);
  }
  if (options.sharpening > 0) {
    picture += options.sharpening * factor(1) * (picture - Blurred(picture, 1));
  }
  if (options.jpeg_quality > 0) {
    CompressAsJpeg(options.jpeg_quality, &picture);
  }
  ColorImage image;
  image.width = radiance.width;
  image.height = radiance.height;
  image.pixels.resize(radiance.pixels.size());
  cv::Mat bytes(picture.size(), CV_8UC3, image.pixels.data());
  picture.convertTo(bytes, CV_8U);
  return image;
}

}  // namespace colmap_ext::synthetic
