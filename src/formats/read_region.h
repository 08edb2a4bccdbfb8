#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "scene/region.h"

namespace colmap_ext {

// Reads a region from a text file: numbers between blanks, line ends or commas,
// behind `#` comments.
//   - 6: x0 y0 z0 x1 y1 z1, two opposite corners of a box along the world's
//     axes, such as CloudCompare shows;
//   - 15: three rows of a rotation, which are the box's axes, its centre, and
//     half its sizes along the axes, as OpenMVS writes regions of interest.
// \throw FileError if the file is missing, or has no such box.
Region ReadRegion(const std::filesystem::path& path);

// The text of 15 numbers that ReadRegion() reads as the same region, but for
// rounding.
std::string RegionText(const Region& region);

// The region of two corners, "x0,y0,z0,x1,y1,z1".
// \return nothing if the text is not six numbers, or they span no box.
std::optional<Region> ParseCorners(std::string_view text);

}  // namespace colmap_ext
