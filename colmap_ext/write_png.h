#pragma once

#include <filesystem>

#include "scene/color_image.h"

namespace colmap_ext {

// \throw FileError if the file can not be written.
void WritePng(const std::filesystem::path& path, const ColorImage& image);

}  // namespace colmap_ext
