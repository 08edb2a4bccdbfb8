#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "scene/images.h"

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

// Returns the bytes of a PNG file: red, green and blue of 8 bits.
// \pre image.width > 0, image.height > 0
std::string EncodePng(const ColorImage& image);

// \throw FileError if the file cannot be written.
void WritePng(const std::filesystem::path& path, const ColorImage& image);

}  // namespace colmap_ext
