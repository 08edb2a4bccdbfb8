#include "photometry/image_pyramid.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

#include <opencv2/imgproc.hpp>

namespace colmap_ext {

namespace {

// Means of the pixels that each new one covers.
GrayImage Resize(GrayImage image, int width, int height) {
  if (image.width == width && image.height == height) {
    return image;
  }
  GrayImage resized{width, height, {}};
  resized.pixels.resize(static_cast<size_t>(width) * height);
  const cv::Mat from(image.height, image.width, CV_8U, image.pixels.data());
  cv::Mat to(height, width, CV_8U, resized.pixels.data());
  cv::resize(from, to, to.size(), 0, 0, cv::INTER_AREA);
  return resized;
}

}  // namespace

View ViewAtLevel(const View& view, int level) {
  const int divisor = 1 << level;
  return ResizeView(view, (view.width + divisor - 1) / divisor,
                    (view.height + divisor - 1) / divisor);
}

ImagePyramid::ImagePyramid(std::vector<View> views, ReadGrayImage read_image,
                           size_t max_memory)
    : views_(std::move(views)),
      level_views_(views_),
      read_image_(std::move(read_image)),
      max_memory_(max_memory) {}

void ImagePyramid::SetLevel(int level) {
  if (level == level_) {
    return;
  }
  level_ = level;
  entries_.clear();
  memory_ = 0;
  for (size_t i = 0; i < views_.size(); ++i) {
    level_views_[i] = ViewAtLevel(views_[i], level);
  }
}

std::shared_ptr<const GrayImage> ImagePyramid::Image(size_t view) {
  const std::scoped_lock lock(mutex_);
  const auto found =
      std::find_if(entries_.begin(), entries_.end(),
                   [view](const Entry& entry) { return entry.view == view; });
  if (found != entries_.end()) {
    entries_.splice(entries_.begin(), entries_, found);
    return found->image;
  }
  GrayImage image = read_image_(view);
  if (image.width != views_[view].width ||
      image.height != views_[view].height) {
    throw std::runtime_error("the image " + views_[view].name +
                             " is not of the size that it had");
  }
  const View& level_view = level_views_[view];
  auto resized = std::make_shared<const GrayImage>(
      Resize(std::move(image), level_view.width, level_view.height));
  memory_ += resized->pixels.size();
  while (!entries_.empty() && memory_ > max_memory_) {
    memory_ -= entries_.back().image->pixels.size();
    entries_.pop_back();
  }
  entries_.push_front({view, resized});
  return resized;
}

}  // namespace colmap_ext
