#pragma once

#include <filesystem>
#include <string>

#include "scene/color_image.h"

namespace colmap_ext {

// Returns the bytes of a PNG file: red, green and blue of 8 bits.
// \pre image.width > 0, image.height > 0
std::string EncodePng(const ColorImage& image);

// \throw FileError if the file can not be written.
void WritePng(const std::filesystem::path& path, const ColorImage& image);

}  // namespace colmap_ext
