#include "colmap_ext/colmap_compat.h"

#include <filesystem>
#include <optional>

#include "formats/picture_files.h"

#if __has_include(<colmap/sensor/bitmap.h>)
#include <colmap/sensor/bitmap.h>
#include <colmap/util/logging.h>
#include <colmap/util/version.h>
#else
#include "util/bitmap.h"
#include "util/logging.h"
#include "util/version.h"
#endif

namespace colmap_ext {
namespace {

// Bitmap::GetPixel fills in a colour up to 4.0, and returns one from 4.1.
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

// Calls use(color) for the pixels of a row. Up to 4.0 a row lies in memory as
// blue, green and red; GetPixel() looks for it for every pixel.
template <typename Bitmap, typename Use>
void ForEachPixel(const Bitmap& bitmap, int y, const Use& use) {
  if constexpr (requires { bitmap.GetScanline(y); }) {
    if (bitmap.IsRGB()) {
      const uint8_t* line = bitmap.GetScanline(y);
      for (int x = 0; x < bitmap.Width(); ++x, line += 3) {
        use(Color{line[2], line[1], line[0]});
      }
      return;
    }
  }
  for (int x = 0; x < bitmap.Width(); ++x) {
    use(GetPixel(bitmap, x, y));
  }
}

// \param pixel_of  what a color becomes in the image.
template <typename Image, typename PixelOf>
std::optional<Image> ReadImage(const std::filesystem::path& path,
                               const PixelOf& pixel_of) {
  colmap::Bitmap bitmap;
  std::error_code error;
  // COLMAP 4 makes up the rest of pictures that are cut off.
  if (!std::filesystem::is_regular_file(path, error) || IsPictureCutOff(path) ||
      !bitmap.Read(path.string())) {
    return std::nullopt;
  }
  Image image{bitmap.Width(), bitmap.Height(), {}};
  image.pixels.reserve(size_t{1} * image.width * image.height);
  for (int y = 0; y < image.height; ++y) {
    ForEachPixel(bitmap, y, [&](const Color& color) {
      image.pixels.push_back(pixel_of(color));
    });
  }
  return image;
}

}  // namespace

void InitializeLogging(char** argv) { colmap::InitializeGlog(argv); }

std::string Versions() {
  const std::string commit = COLMAP_EXT_COMMIT;
  const std::string build = colmap::GetBuildInfo();
  return "colmap_ext " COLMAP_EXT_VERSION +
         (commit.empty() ? "" : " (" + commit + ")") + " with " +
         colmap::GetVersionInfo() +
         (build.find("Unknown") == std::string::npos ? " (" + build + ")" : "");
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

}  // namespace colmap_ext
