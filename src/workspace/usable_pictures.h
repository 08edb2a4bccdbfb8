#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "scene/gray_image.h"
#include "scene/picture_decoder.h"
#include "scene/point_cloud.h"
#include "scene/view.h"

namespace colmap_ext {

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

// Takes the views whose pictures can not be used from the points, so that no
// pair of views is made of them. Views keep their indices.
// \throw FileError if fewer than two are left.
void RemoveUnusable(const std::filesystem::path& images_path,
                    const std::vector<std::string>& errors, PointCloud* points);

// Reads the pictures at full size.
ReadGrayImage PictureReader(const std::filesystem::path& images_path,
                            const std::vector<View>& views,
                            const PictureDecoder& decoder);

}  // namespace colmap_ext
