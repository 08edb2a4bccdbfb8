#include "pictures/pictures.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "base/percentile.h"

namespace colmap_ext {
namespace {

constexpr int kStripHeight = 70;  // px, of the scale below the picture
constexpr int kMargin = 40;       // px
constexpr int kBarTop = 12;       // px
constexpr int kBarHeight = 16;    // px

void DrawCentered(const std::string& text, int x, int y, cv::Mat* picture) {
  constexpr double kSize = 0.45;
  const int font = cv::FONT_HERSHEY_SIMPLEX;
  const cv::Size size = cv::getTextSize(text, font, kSize, 1, nullptr);
  cv::putText(*picture, text, {x - size.width / 2, y + size.height}, font,
              kSize, cv::Scalar::all(0), 1, cv::LINE_AA);
}

void DrawScale(double scale, int top, cv::Mat* picture) {
  const int length = std::max(1, picture->cols - 2 * kMargin);
  for (int i = 0; i < length; ++i) {
    const Color color = ErrorColor(i + 0.5, length);
    cv::line(*picture, {kMargin + i, top + kBarTop},
             {kMargin + i, top + kBarTop + kBarHeight},
             {1.0 * color[0], 1.0 * color[1], 1.0 * color[2]});
  }
  const int text_top = top + kBarTop + kBarHeight + 6;
  constexpr int kNumSteps = 4;
  for (int i = 0; i <= kNumSteps; ++i) {
    DrawCentered(fmt::format("{:g}", scale * i / kNumSteps),
                 kMargin + length * i / kNumSteps, text_top, picture);
  }
  DrawCentered("distance to the truth, scene units", picture->cols / 2,
               text_top + 18, picture);
}

}  // namespace

Color ErrorColor(double error, double scale) {
  constexpr Color kViridis[] = {{68, 1, 84},    {72, 40, 120},  {62, 74, 137},
                                {49, 104, 142}, {38, 130, 142}, {31, 158, 137},
                                {53, 183, 121}, {109, 205, 89}, {180, 222, 44},
                                {253, 231, 37}};
  constexpr size_t kLast = std::size(kViridis) - 1;
  const double position = std::clamp(error / scale, 0.0, 1.0) * kLast;
  const size_t index = std::min(static_cast<size_t>(position), kLast - 1);
  const double weight = position - static_cast<double>(index);
  Color color;
  for (size_t i = 0; i < color.size(); ++i) {
    color[i] = static_cast<uint8_t>(std::lround(
        (1 - weight) * kViridis[index][i] + weight * kViridis[index + 1][i]));
  }
  return color;
}

double ErrorScale(std::vector<double> errors) {
  const double most = errors.empty() ? 0 : Percentile(95, &errors);
  if (!(most > 0)) {
    return 1;
  }
  const double power = std::pow(10, std::floor(std::log10(most)));
  for (const double factor : {1, 2, 5}) {
    if (factor * power >= most) {
      return factor * power;
    }
  }
  return 10 * power;
}

ColorImage DrawErrors(const TriangleMesh& mesh,
                      const std::vector<Color>& colors, const View& view,
                      double scale) {
  ColorImage image = RenderMesh(mesh, view, VertexColors(mesh, colors, 0));
  const int top = image.height;
  image.height += kStripHeight;
  image.pixels.resize(static_cast<size_t>(image.width) * image.height,
                      Color{255, 255, 255});
  // Shares the image's pixels; OpenCV's colors are blue, green, red.
  cv::Mat picture(image.height, image.width, CV_8UC3, image.pixels.data());
  DrawScale(scale, top, &picture);
  return image;
}

ColorImage DrawPoints(const PointCloud& cloud, const View& view, int side) {
  constexpr Color kGray = {128, 128, 128};
  const size_t num_pixels = static_cast<size_t>(view.width) * view.height;
  ColorImage image{view.width, view.height,
                   std::vector<Color>(num_pixels, {255, 255, 255})};
  std::vector<double> depths(num_pixels,
                             std::numeric_limits<double>::infinity());
  for (size_t i = 0; i < cloud.size(); ++i) {
    const Eigen::Vector3d point =
        view.CamFromWorld(cloud.positions[i].cast<double>());
    if (!(point.z() > 0)) {
      continue;
    }
    const Eigen::Vector2d corner =
        view.ImageFromCam(point).array() - 0.5 * side;
    if (!(corner.x() > -side && corner.x() < view.width && corner.y() > -side &&
          corner.y() < view.height)) {
      continue;
    }
    const int left = static_cast<int>(std::lround(corner.x()));
    const int top = static_cast<int>(std::lround(corner.y()));
    for (int row = std::max(top, 0); row < std::min(top + side, view.height);
         ++row) {
      for (int col = std::max(left, 0); col < std::min(left + side, view.width);
           ++col) {
        const size_t pixel = static_cast<size_t>(row) * view.width + col;
        if (point.z() < depths[pixel]) {
          depths[pixel] = point.z();
          image.pixels[pixel] = cloud.colors.empty() ? kGray : cloud.colors[i];
        }
      }
    }
  }
  return image;
}

ColorImage ResizePicture(const ColorImage& image, int width, int height) {
  ColorImage resized{width, height,
                     std::vector<Color>(static_cast<size_t>(width) * height)};
  // OpenCV only reads the pixels of the first.
  const cv::Mat from(image.height, image.width, CV_8UC3,
                     const_cast<Color*>(image.pixels.data()));
  cv::Mat to(height, width, CV_8UC3, resized.pixels.data());
  cv::resize(from, to, to.size(), 0, 0, cv::INTER_AREA);
  return resized;
}

ColorImage ShrinkPicture(ColorImage image, int max_size) {
  const int64_t longest = std::max(image.width, image.height);
  if (longest <= max_size) {
    return image;
  }
  const auto shrunk = [&](int size) {
    return std::max(1, static_cast<int>(int64_t{size} * max_size / longest));
  };
  return ResizePicture(image, shrunk(image.width), shrunk(image.height));
}

}  // namespace colmap_ext
