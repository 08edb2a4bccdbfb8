#include "tests/workspace/netpbm_decoder.h"

#include <fstream>
#include <string>

namespace colmap_ext {

namespace {

std::optional<ColorImage> ReadColor(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::string magic;
  ColorImage image;
  int max_value = 0;
  file >> magic >> image.width >> image.height >> max_value;
  if (!file || max_value != 255 || (magic != "P5" && magic != "P6")) {
    return std::nullopt;
  }
  file.get();
  for (int i = 0; i < image.width * image.height; ++i) {
    Color color;
    for (uint8_t& channel : color) {
      channel = magic == "P5" && &channel != color.data()
                    ? color[0]
                    : static_cast<uint8_t>(file.get());
    }
    image.pixels.push_back(color);
  }
  return file ? std::optional(image) : std::nullopt;
}

std::optional<GrayImage> ReadGray(const std::filesystem::path& path) {
  const std::optional<ColorImage> color = ReadColor(path);
  if (!color) {
    return std::nullopt;
  }
  GrayImage gray{color->width, color->height, {}};
  for (const Color& pixel : color->pixels) {
    gray.pixels.push_back(
        static_cast<uint8_t>((pixel[0] + pixel[1] + pixel[2]) / 3));
  }
  return gray;
}

}  // namespace

PictureDecoder NetpbmDecoder() { return {&ReadColor, &ReadGray}; }

}  // namespace colmap_ext
