#include "formats/encode_png.h"

#include <stdexcept>

#include <png.h>

#include "formats/atomic_file.h"

namespace colmap_ext {

std::string EncodePng(const ColorImage& image) {
  png_image header = {};
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(image.width);
  header.height = static_cast<png_uint_32>(image.height);
  header.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(header);
  std::string bytes(size, '\0');
  if (png_image_write_to_memory(&header, bytes.data(), &size, 0,
                                image.pixels.data(), 0, nullptr) == 0) {
    throw std::runtime_error("a picture can not be compressed");
  }
  bytes.resize(size);
  return bytes;
}

void WritePng(const std::filesystem::path& path, const ColorImage& image) {
  WriteText(path, EncodePng(image));
}

}  // namespace colmap_ext
