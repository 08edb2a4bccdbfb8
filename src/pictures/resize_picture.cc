#include "pictures/resize_picture.h"

#include <cstddef>
#include <vector>

#include <opencv2/imgproc.hpp>

namespace colmap_ext {

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

}  // namespace colmap_ext
