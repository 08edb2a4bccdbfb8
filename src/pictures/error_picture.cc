#include "pictures/error_picture.h"

#include <algorithm>
#include <string>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "pictures/error_colors.h"
#include "pictures/mesh_renderer.h"

namespace colmap_ext {

namespace {

constexpr int kStripHeight = 70;  // px, of the scale below the picture
constexpr int kMargin = 40;       // px
constexpr int kBarTop = 12;       // px
constexpr int kBarHeight = 16;    // px

// A view on the image's pixels; OpenCV counts colours from blue on.
cv::Mat AsMat(ColorImage* image) {
  return {image->height, image->width, CV_8UC3, image->pixels.data()};
}

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

ColorImage DrawErrors(const TriangleMesh& mesh,
                      const std::vector<Color>& colors, const View& view,
                      double scale) {
  ColorImage image = RenderVertexColors(mesh, colors, view);
  const int top = image.height;
  image.height += kStripHeight;
  image.pixels.resize(static_cast<size_t>(image.width) * image.height,
                      Color{255, 255, 255});
  cv::Mat picture = AsMat(&image);
  DrawScale(scale, top, &picture);
  return image;
}

}  // namespace colmap_ext
