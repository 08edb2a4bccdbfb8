#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "scene/region.h"

namespace colmap_ext {

// The finite numbers of a text, between blanks, line ends or commas; what
// follows a `#` in its line is a comment.
// \return nothing if there is anything else in it
std::optional<std::vector<double>> ParseNumbers(std::string_view text);

// The same of a file of a few numbers.
// \throw FileError if it is missing, has anything else in it, or is longer than
//        64 KB.
std::vector<double> ReadNumbers(const std::filesystem::path& path);

// Reads a region from a text file: numbers between blanks, line ends or commas,
// behind `#` comments.
//   - 6: x0 y0 z0 x1 y1 z1, two opposite corners of a box along the world's
//     axes, such as CloudCompare shows;
//   - 15: three rows of a rotation, which are the box's axes, its centre, and
//     half its sizes along the axes, as OpenMVS writes regions of interest.
// \throw FileError if the file is missing, or has no such box.
Region ReadRegion(const std::filesystem::path& path);

// The text of 15 numbers that ReadRegion() reads as the same, but for rounding.
std::string RegionText(const Region& region);

// The region of two corners, "x0,y0,z0,x1,y1,z1".
// \return nothing if the text is not six numbers, or they span no box.
std::optional<Region> ParseCorners(std::string_view text);

// Reads a similarity transform, homogeneous, of points as columns: 16 numbers,
// a 4 x 4 matrix row by row, as COLMAP 3.8's model_aligner writes it, or 8, its
// scale, quaternion (w x y z) and translation, as later ones do.
// \throw FileError if the file is missing, or has no such transform: one that
//        mirrors or shears is none.
Eigen::Matrix4d ReadTransform(const std::filesystem::path& path);

}  // namespace colmap_ext
