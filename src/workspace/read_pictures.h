#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "scene/images.h"
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
// \throw FileError if no image has a mask; when a mask is read, if it cannot
//        be, or is not of its image's size.
ReadGrayImage MaskReader(const std::filesystem::path& folder,
                         const std::vector<View>& views,
                         const PictureDecoder& decoder);

// Reads the depth maps of views from a folder; empty ones of views without a
// file.
//
// \pre there are views; they outlive the result
// \throw FileError if no view has a depth map; when one is read, as
//        ReadDepthMap().
std::function<DepthMap(size_t view)> DepthMapReader(
    const std::filesystem::path& folder, const std::vector<View>& views);

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

// Reads all pictures that nothing is known to be wrong with, in parallel, so
// that none fails hours later.
// \param read  reads the picture of a view, and throws if that fails.
// \param errors  [views] what is wrong with each picture; empty: nothing.
void FindUnreadable(const std::function<void(size_t view)>& read,
                    std::vector<std::string>* errors);

// \throw FileError that lists the pictures that something is wrong with.
void ExpectPictures(const std::filesystem::path& images_path,
                    const std::vector<View>& views,
                    const std::vector<std::string>& errors);

// The pictures that something is wrong with, the first few by name: "3 of 12:
// a.png: no such file; ...".
std::string DescribeErrors(const std::vector<View>& views,
                           const std::vector<std::string>& errors);

// Takes the views whose pictures cannot be used from the points, so that no
// pair of views is made of them. Views keep their indices.
// \throw FileError if fewer than two are left.
void RemoveUnusable(const std::filesystem::path& images_path,
                    const std::vector<std::string>& errors, PointCloud* points);

// Reads the pictures at full size.
ReadGrayImage PictureReader(const std::filesystem::path& images_path,
                            const std::vector<View>& views,
                            const PictureDecoder& decoder);

}  // namespace colmap_ext
