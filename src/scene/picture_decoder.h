#pragma once

#include <filesystem>
#include <functional>
#include <optional>

#include "scene/color_image.h"
#include "scene/gray_image.h"

namespace colmap_ext {

// Decodes picture files. Handed in, so that nothing but the program depends on
// a library of picture formats. Called by several threads at a time.
struct PictureDecoder {
  // \return nothing if there is no such file, or it is no picture.
  std::function<std::optional<ColorImage>(const std::filesystem::path&)>
      read_color;
  std::function<std::optional<GrayImage>(const std::filesystem::path&)>
      read_gray;
};

}  // namespace colmap_ext
