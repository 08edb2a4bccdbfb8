#include "formats/picture_files.h"

#include <cstdint>
#include <vector>

#include <gtest/gtest.h>
#include <png.h>

#include "tests/random.h"

namespace colmap_ext::encode_png_test {

ColorImage Decode(const std::string& bytes) {
  png_image header = {};
  header.version = PNG_IMAGE_VERSION;
  EXPECT_NE(
      png_image_begin_read_from_memory(&header, bytes.data(), bytes.size()), 0);
  EXPECT_EQ(header.format, PNG_FORMAT_RGB);
  ColorImage image{static_cast<int>(header.width),
                   static_cast<int>(header.height),
                   std::vector<Color>(size_t{header.width} * header.height)};
  EXPECT_NE(
      png_image_finish_read(&header, nullptr, image.pixels.data(), 0, nullptr),
      0);
  return image;
}

TEST(EncodePngTest, KeepsEveryPixel) {
  Random random(3);
  for (const int width : {1, 2, 7, 64}) {
    for (const int height : {1, 5, 33}) {
      ColorImage image{width, height, {}};
      for (int i = 0; i < width * height; ++i) {
        const auto noise = static_cast<uint8_t>(255 * random.Unit());
        image.pixels.push_back({noise, 255, static_cast<uint8_t>(i)});
      }
      const std::string bytes = EncodePng(image);
      const ColorImage decoded = Decode(bytes);
      EXPECT_EQ(decoded.width, width);
      EXPECT_EQ(decoded.height, height);
      EXPECT_EQ(decoded.pixels, image.pixels);
      EXPECT_EQ(bytes, EncodePng(image));
    }
  }
}

TEST(EncodePngTest, IsSmallWhereThePictureIsSmooth) {
  constexpr int kSide = 200;
  ColorImage image{kSide, kSide, {}};
  for (int i = 0; i < kSide * kSide; ++i) {
    const auto value = static_cast<uint8_t>(i % kSide + i / kSide / 4);
    image.pixels.push_back({value, value, value});
  }
  EXPECT_LT(EncodePng(image).size(), 2000);
}

}  // namespace colmap_ext::encode_png_test
