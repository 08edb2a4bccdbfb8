#pragma once

#include <filesystem>
#include <optional>

namespace colmap_ext {

struct ImageSize {
  int width = 0;   // px
  int height = 0;  // px
};

// The size of a picture, of PNG and JPEG files from their headers alone.
// \return nothing if there is no such file, or it is none that COLMAP reads.
std::optional<ImageSize> ReadImageSize(const std::filesystem::path& path);

}  // namespace colmap_ext
