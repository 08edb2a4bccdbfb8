#pragma once

#include <cstddef>
#include <list>
#include <memory>
#include <mutex>
#include <vector>

#include "scene/gray_image.h"
#include "scene/view.h"

namespace colmap_ext {

// The view of an image halved `level` times; sizes are rounded up.
View ViewAtLevel(const View& view, int level);

// Images at one level of their pyramids, means of the pixels that they cover.
// They are read when they are asked for, and the one that was not used for the
// longest time is dropped when there are too many. Safe from several threads.
class ImagePyramid {
 public:
  // \param views  the full size.
  // \param max_memory  of the images that are kept, bytes; what is in use is
  //        kept whatever it takes.
  ImagePyramid(std::vector<View> views, ReadGrayImage read_image,
               size_t max_memory);

  // Drops what is kept of another level.
  void SetLevel(int level);

  // \throw what read_image throws; std::runtime_error if the image is not of
  //        its view's size.
  std::shared_ptr<const GrayImage> Image(size_t view);

  // [views] at the level.
  const std::vector<View>& Views() const { return level_views_; }

 private:
  struct Entry {
    size_t view;
    std::shared_ptr<const GrayImage> image;
  };

  std::vector<View> views_;
  std::vector<View> level_views_;
  ReadGrayImage read_image_;
  size_t max_memory_;
  int level_ = 0;

  std::mutex mutex_;
  std::list<Entry> entries_;  // the last used first
  size_t memory_ = 0;         // of the entries, bytes
};

}  // namespace colmap_ext
