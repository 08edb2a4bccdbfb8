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

// Whether a PNG or JPEG file ends before its picture does, as those of copies
// that were interrupted; some decoders take them, and make up the rest.
// \return false for whatever is no such file.
bool IsPictureCutOff(const std::filesystem::path& path);

}  // namespace colmap_ext
