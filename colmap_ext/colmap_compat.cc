#include "colmap_ext/colmap_compat.h"

#include <fstream>
#include <iostream>
#include <optional>
#include <type_traits>

#if __has_include(<colmap/sensor/bitmap.h>)
#include <colmap/sensor/bitmap.h>
#include <colmap/util/logging.h>
#else
#include "util/bitmap.h"
#include "util/logging.h"
#endif

namespace colmap_ext {

namespace {

// OptionManager::Parse returns nothing up to 3.12, and ends the program where
// the options are wrong.
template <typename Options>
bool Parse(int argc, char** argv, Options* options) {
  if constexpr (std::is_void_v<decltype(options->Parse(argc, argv))>) {
    options->Parse(argc, argv);
    return true;
  } else {
    return options->Parse(argc, argv);
  }
}

// COLMAP aborts on a project file that exists but can not be read.
bool IsProjectFileReadable(int argc, char** argv) {
  const std::string option = "--project_path";
  for (int i = 1; i < argc; ++i) {
    std::string path;
    if (argv[i] == option && i + 1 < argc) {
      path = argv[i + 1];
    } else if (std::string(argv[i]).starts_with(option + "=")) {
      path = argv[i] + option.size() + 1;
    }
    if (!path.empty() && !std::ifstream(path).is_open()) {
      std::cerr << "ERROR: " << path << ": can not be read" << std::endl;
      return false;
    }
  }
  return true;
}

// Bitmap::GetPixel fills in a colour up to 3.x, and returns one from 4.0.
template <typename Bitmap>
Color GetPixel(const Bitmap& bitmap, int x, int y) {
  colmap::BitmapColor<uint8_t> color(0, 0, 0);
  if constexpr (requires { bitmap.GetPixel(x, y, &color); }) {
    bitmap.GetPixel(x, y, &color);
  } else {
    color = bitmap.GetPixel(x, y).value_or(color);
  }
  return {color.r, color.g, color.b};
}

// Before COLMAP 4.0 an empty bitmap is given a size, later it is made with one.
template <typename Bitmap>
Bitmap MakeBitmap(int width, int height) {
  if constexpr (requires(Bitmap b) { b.Allocate(width, height, true); }) {
    Bitmap bitmap;
    bitmap.Allocate(width, height, true);
    return bitmap;
  } else {
    return Bitmap(width, height, true);
  }
}

// \param pixel_of  what a color becomes in the image.
template <typename Image, typename PixelOf>
std::optional<Image> ReadImage(const std::filesystem::path& path,
                               const PixelOf& pixel_of) {
  colmap::Bitmap bitmap;
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error) ||
      !bitmap.Read(path.string())) {
    return std::nullopt;
  }
  Image image{bitmap.Width(), bitmap.Height(), {}};
  image.pixels.reserve(size_t{1} * image.width * image.height);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      image.pixels.push_back(pixel_of(GetPixel(bitmap, x, y)));
    }
  }
  return image;
}

}  // namespace

void InitializeLogging(char** argv) { colmap::InitializeGlog(argv); }

bool ParseOptions(int argc, char** argv, colmap::OptionManager* options) {
  return IsProjectFileReadable(argc, argv) && Parse(argc, argv, options);
}

PictureDecoder ColmapPictureDecoder() {
  return {[](const std::filesystem::path& path) {
            return ReadImage<ColorImage>(
                path, [](const Color& color) { return color; });
          },
          [](const std::filesystem::path& path) {
            return ReadImage<GrayImage>(path, [](const Color& color) {
              return static_cast<uint8_t>(
                  (color[0] + 2 * color[1] + color[2] + 2) / 4);
            });
          }};
}

bool WriteColorImage(const std::filesystem::path& path,
                     const ColorImage& image) {
  auto bitmap = MakeBitmap<colmap::Bitmap>(image.width, image.height);
  for (int row = 0; row < image.height; ++row) {
    for (int col = 0; col < image.width; ++col) {
      const Color& color = image.At(row, col);
      bitmap.SetPixel(
          col, row, colmap::BitmapColor<uint8_t>(color[0], color[1], color[2]));
    }
  }
  return bitmap.Write(path.string());
}

}  // namespace colmap_ext
