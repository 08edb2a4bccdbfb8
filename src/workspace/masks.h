#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "scene/gray_image.h"
#include "scene/picture_decoder.h"
#include "scene/point_cloud.h"
#include "scene/view.h"

namespace colmap_ext {

// The file of an image's mask, by COLMAP's convention: "a.jpg.png" for "a.jpg",
// or, for PNG images, the same name.
// \return an empty path if there is none
std::filesystem::path FindMask(const std::filesystem::path& folder,
                               const std::string& image_name);

// Reads masks at the size of their images: pixels of 0 are masked, all others
// are 255. Images without a file have an empty mask.
//
// \throw FileError if no image has a mask; when a mask is read, if it can not
//        be, or is not of its image's size.
ReadGrayImage MaskReader(const std::filesystem::path& folder,
                         const std::vector<View>& views,
                         const PictureDecoder& decoder);

// Keeps the masks that were read, a bit a pixel, so that they are decoded once
// as far as memory allows.
// \param max_memory  of the masks that are kept, bytes
ReadGrayImage KeepMasks(const ReadGrayImage& read_mask,
                        const std::vector<View>& views, size_t max_memory);

struct MaskReport {
  size_t num_masks = 0;                // of views that see points
  size_t num_masked_observations = 0;  // of points, dropped
  size_t num_masked_points = 0;        // that no view sees any more, dropped
};

// Removes from each point the views that see it in a masked pixel, and drops
// points without remaining views.
MaskReport MaskCloud(const ReadGrayImage& read_mask,
                     const std::vector<View>& views, PointCloud* cloud);

}  // namespace colmap_ext
