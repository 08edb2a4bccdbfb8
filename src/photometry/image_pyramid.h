#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <vector>

#include "base/lru_cache.h"
#include "scene/images.h"
#include "scene/view.h"

namespace colmap_ext {

// How much farther from the principal point a lens shows points than a pinhole
// camera, in half diagonals of the image: at equal steps of the distance, from
// 0, where it is 0, to half the diagonal; linear between.
using RadialShifts = std::array<double, 17>;

// Half of the image's diagonal, px.
inline double HalfDiagonal(const View& view) {
  return std::hypot(view.width, view.height) / 2;
}

// The views of images halved `level` times; sizes are rounded up.
std::vector<View> ViewsAtLevel(std::vector<View> views, int level);

// The view of an image at a scale: 0.5 is half the width and height, rounded.
View ViewAtScale(const View& view, double scale);

// Reads images in the sizes of other views of the same pictures: a pixel is the
// mean of those that it covers.
// \param from  the views that `read` reads
// \throw what `read` throws; std::runtime_error if an image is not of the size
//        of its view
ReadGrayImage ResizedImages(ReadGrayImage read, std::vector<View> from,
                            std::vector<View> to);

// The same of masks, 0 or 255: a pixel is 0 if any of those that it covers is.
// \param read  may be empty, and then the result is; or give empty masks
ReadGrayImage ResizedMasks(ReadGrayImage read, std::vector<View> to);

// Images at one level of their pyramids: a pixel is the mean of the full-size
// pixels that it covers. Images are read on demand. If memory allows, the full
// size is kept too, so that each file is read once for all levels; the least
// recently used images are dropped. Image() is thread-safe.
class ImagePyramid {
 public:
  // \param views  the full size.
  // \param max_memory  of the images that are kept, bytes. The image read last
  //        is always kept, and images in use stay valid.
  // \param read_mask  of the views, pixels of 0 are masked; an empty image
  //        where there is none; may be empty itself. Masks share the memory.
  // \param max_borrowed  what the images of a level may take beyond max_memory,
  //        bytes, where that keeps all of them: reading one again takes longer
  //        than whatever else the memory would serve.
  ImagePyramid(std::vector<View> views, ReadGrayImage read_image,
               size_t max_memory, ReadGrayImage read_mask = {},
               size_t max_borrowed = 0);

  // Drops what is kept of another level but the full size.
  // \pre no other thread uses the pyramid meanwhile
  void SetLevel(int level);
  int Level() const { return level_; }

  // Other cameras of the same pictures.
  // \pre the views have the sizes that they had; no other thread uses the
  //      pyramid meanwhile
  void SetViews(std::vector<View> views);

  // Corrects the images for their lenses, [views]; empty: none.
  // \pre no other thread uses the pyramid meanwhile
  void CorrectLenses(std::vector<RadialShifts> shifts);

  // \throw what read_image throws; std::runtime_error if the image is not of
  //        its view's size.
  std::shared_ptr<const GrayImage> Image(size_t view);

  // The mask of a view at the level, or nothing: a pixel is 0 if any of the
  // full-size pixels that it covers is, else 255.
  // \throw what read_mask throws.
  std::shared_ptr<const GrayImage> Mask(size_t view);

  // What the images of the level may take beyond max_memory, bytes.
  size_t BorrowedMemory() const { return borrowed_; }

  // [views] at the level.
  const std::vector<View>& Views() const { return level_views_; }

 private:
  void ShareMemory();
  std::shared_ptr<const GrayImage> FullImage(size_t view);

  std::vector<View> views_;
  std::vector<View> level_views_;
  std::vector<RadialShifts> radial_shifts_;  // [views], or empty
  ReadGrayImage read_image_;
  ReadGrayImage read_mask_;
  size_t max_memory_;
  size_t max_borrowed_;
  size_t borrowed_ = 0;
  int level_ = 0;
  LruCache<const GrayImage> full_images_;   // of what level_images_ leaves
  LruCache<const GrayImage> level_images_;  // empty at level 0
  LruCache<const GrayImage> level_masks_;
};

}  // namespace colmap_ext
