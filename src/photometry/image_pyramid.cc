#include "photometry/image_pyramid.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <tbb/task_arena.h>
#include <opencv2/imgproc.hpp>

namespace colmap_ext {
namespace {

size_t NumPixels(const View& view) {
  return static_cast<size_t>(view.width) * view.height;
}

cv::Mat MatOf(const GrayImage& image) {
  // OpenCV has no views of constant pixels.
  return {image.height, image.width, CV_8U,
          const_cast<uint8_t*>(image.pixels.data())};
}

// A pixel is the mean of those that it covers.
// \param size  has the width and height
GrayImage Resize(const GrayImage& image, const View& size) {
  GrayImage resized{size.width, size.height, {}};
  resized.pixels.resize(NumPixels(size));
  cv::Mat to = MatOf(resized);
  cv::resize(MatOf(image), to, to.size(), 0, 0, cv::INTER_AREA);
  return resized;
}

// A pixel is masked if any of those that it covers is.
GrayImage ResizeMask(const GrayImage& mask, const View& size) {
  GrayImage resized = Resize(mask, size);
  for (uint8_t& pixel : resized.pixels) {
    pixel = pixel == 255 ? 255 : 0;
  }
  return resized;
}

// Resamples an image to that of a pinhole camera.
GrayImage WithoutShifts(const GrayImage& image, const View& view,
                        const RadialShifts& shifts) {
  constexpr int kNumSteps = std::tuple_size_v<RadialShifts> - 1;
  GrayImage corrected{image.width, image.height, {}};
  corrected.pixels.resize(image.pixels.size());
  cv::Mat cols(image.height, image.width, CV_32F);
  cv::Mat rows(image.height, image.width, CV_32F);
  const double half = HalfDiagonal(view);
  for (int row = 0; row < image.height; ++row) {
    for (int col = 0; col < image.width; ++col) {
      const double u = col + 0.5 - view.cx;
      const double v = row + 0.5 - view.cy;
      const double distance = std::max(std::hypot(u, v) / half, 1e-9);
      const double place = std::min(distance, 1.0) * kNumSteps;
      const int step = std::min(static_cast<int>(place), kNumSteps - 1);
      const double shift =
          std::lerp(shifts[step], shifts[step + 1], place - step);
      cols.at<float>(row, col) = static_cast<float>(col + u * shift / distance);
      rows.at<float>(row, col) = static_cast<float>(row + v * shift / distance);
    }
  }
  cv::Mat to = MatOf(corrected);
  cv::remap(MatOf(image), to, cols, rows, cv::INTER_LANCZOS4,
            cv::BORDER_REPLICATE);
  return corrected;
}

bool HasSizeOf(const View& view, const GrayImage& image) {
  return image.width == view.width && image.height == view.height;
}

// \throw std::runtime_error if the image is not of its view's size
void ExpectSize(const GrayImage& image, const View& view) {
  if (!HasSizeOf(view, image)) {
    throw std::runtime_error("the image " + view.name +
                             " is not of the size that it had");
  }
}

}  // namespace

std::vector<View> ViewsAtLevel(std::vector<View> views, int level) {
  const int divisor = 1 << level;
  for (View& view : views) {
    view = ResizeView(view, (view.width + divisor - 1) / divisor,
                      (view.height + divisor - 1) / divisor);
  }
  return views;
}

View ViewAtScale(const View& view, double scale) {
  const auto scaled = [scale](int size) {
    return std::max(1, static_cast<int>(std::lround(scale * size)));
  };
  return ResizeView(view, scaled(view.width), scaled(view.height));
}

ReadGrayImage ResizedImages(ReadGrayImage read, std::vector<View> from,
                            std::vector<View> to) {
  return [read = std::move(read), from = std::move(from),
          to = std::move(to)](size_t view) {
    GrayImage image = read(view);
    ExpectSize(image, from[view]);
    return HasSizeOf(to[view], image) ? std::move(image)
                                      : Resize(image, to[view]);
  };
}

ReadGrayImage ResizedMasks(ReadGrayImage read, std::vector<View> to) {
  if (!read) {
    return read;
  }
  return [read = std::move(read), to = std::move(to)](size_t view) {
    GrayImage mask = read(view);
    return mask.pixels.empty() || HasSizeOf(to[view], mask)
               ? std::move(mask)
               : ResizeMask(mask, to[view]);
  };
}

ImagePyramid::ImagePyramid(std::vector<View> views, ReadGrayImage read_image,
                           size_t max_memory, ReadGrayImage read_mask,
                           size_t max_borrowed)
    : views_(std::move(views)),
      level_views_(views_),
      read_image_(std::move(read_image)),
      read_mask_(std::move(read_mask)),
      max_memory_(max_memory),
      max_borrowed_(max_borrowed),
      full_images_(max_memory),
      level_images_(max_memory),
      level_masks_(max_memory) {
  ShareMemory();
}

// The images of the level, and their masks, are used again and again; the full
// size, for what they leave, once a level.
void ImagePyramid::ShareMemory() {
  const size_t num_kinds = read_mask_ ? 2 : 1;
  size_t level_memory = 0;
  for (const View& view : level_views_) {
    level_memory += num_kinds * NumPixels(view);
  }
  const size_t missing = level_memory - std::min(max_memory_, level_memory);
  borrowed_ = missing <= max_borrowed_ ? missing : 0;
  const size_t memory = max_memory_ + borrowed_;
  level_images_.SetMaxBytes(memory / num_kinds);
  level_masks_.SetMaxBytes(memory / num_kinds);
  full_images_.SetMaxBytes(level_ == 0
                               ? memory / num_kinds
                               : memory - std::min(memory, level_memory));
}

void ImagePyramid::SetLevel(int level) {
  if (level == level_) {
    return;
  }
  level_ = level;
  level_images_.Clear();
  level_masks_.Clear();
  SetViews(std::move(views_));
  ShareMemory();
}

void ImagePyramid::SetViews(std::vector<View> views) {
  views_ = std::move(views);
  level_views_ = ViewsAtLevel(views_, level_);
}

void ImagePyramid::CorrectLenses(std::vector<RadialShifts> shifts) {
  if (shifts != radial_shifts_) {
    radial_shifts_ = std::move(shifts);
    full_images_.Clear();
    level_images_.Clear();
  }
}

std::shared_ptr<const GrayImage> ImagePyramid::FullImage(size_t view) {
  return full_images_.Get(view, NumPixels(views_[view]), [&] {
    GrayImage image = read_image_(view);
    ExpectSize(image, views_[view]);
    return std::make_shared<const GrayImage>(
        radial_shifts_.empty()
            ? std::move(image)
            : WithoutShifts(image, views_[view], radial_shifts_[view]));
  });
}

std::shared_ptr<const GrayImage> ImagePyramid::Image(size_t view) {
  // OpenCV and decoders may run tasks: while this thread waits for them, it
  // must not begin a task that waits for this image.
  return tbb::this_task_arena::isolate([&] {
    const View& size = level_views_[view];
    return level_ == 0 ? FullImage(view)
                       : level_images_.Get(view, NumPixels(size), [&] {
                           return std::make_shared<const GrayImage>(
                               Resize(*FullImage(view), size));
                         });
  });
}

std::shared_ptr<const GrayImage> ImagePyramid::Mask(size_t view) {
  if (!read_mask_) {
    return nullptr;
  }
  const auto mask = tbb::this_task_arena::isolate([&] {  // as in Image()
    const View& size = level_views_[view];
    return level_masks_.Get(view, NumPixels(size), [&] {
      GrayImage full = read_mask_(view);
      return std::make_shared<const GrayImage>(
          level_ == 0 || full.pixels.empty() ? std::move(full)
                                             : ResizeMask(full, size));
    });
  });
  return mask->pixels.empty() ? nullptr : mask;
}

}  // namespace colmap_ext
