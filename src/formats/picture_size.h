#pragma once

#include <filesystem>
#include <optional>

namespace colmap_ext {

struct PictureSize {
  int width = 0;   // px
  int height = 0;  // px
};

// The size of a PNG or JPEG picture, from the file's header alone.
// \return nothing if there is no such file, or it is another or damaged.
std::optional<PictureSize> ReadPictureSize(const std::filesystem::path& path);

}  // namespace colmap_ext
