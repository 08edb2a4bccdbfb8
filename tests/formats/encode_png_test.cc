#include "formats/encode_png.h"

#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <zlib.h>

#include "tests/random.h"

namespace colmap_ext {
namespace encode_png_test {

uint32_t BigEndian(const std::string& bytes, size_t at) {
  uint32_t number = 0;
  for (size_t i = at; i < at + 4; ++i) {
    number = number << 8 | static_cast<uint8_t>(bytes[i]);
  }
  return number;
}

// Checks the chunks, and returns the data of the one called `type`.
std::string ChunkData(const std::string& png, const std::string& type) {
  std::string data;
  size_t at = 8;
  while (at + 12 <= png.size()) {
    const uint32_t size = BigEndian(png, at);
    const auto* body = reinterpret_cast<const Bytef*>(png.data() + at + 4);
    EXPECT_EQ(BigEndian(png, at + 8 + size), crc32(0, body, size + 4));
    if (png.substr(at + 4, 4) == type) {
      data = png.substr(at + 8, size);
    }
    at += 12 + size;
  }
  EXPECT_EQ(at, png.size());
  return data;
}

// The standard's own words for the predictor (section 9.4).
int Paeth(int a, int b, int c) {
  const int p = a + b - c;
  const int pa = std::abs(p - a);
  const int pb = std::abs(p - b);
  const int pc = std::abs(p - c);
  return pa <= pb && pa <= pc ? a : pb <= pc ? b : c;
}

std::vector<Color> Decode(const std::string& png, int width, int height) {
  const std::string data = ChunkData(png, "IDAT");
  const size_t stride = 3 * width + 1;
  std::vector<uint8_t> rows(stride * height);
  uLongf size = rows.size();
  EXPECT_EQ(
      uncompress(rows.data(), &size,
                 reinterpret_cast<const Bytef*>(data.data()), data.size()),
      Z_OK);
  EXPECT_EQ(size, rows.size());
  std::vector<Color> pixels(static_cast<size_t>(width) * height);
  for (int row = 0; row < height; ++row) {
    uint8_t* bytes = &rows[row * stride];
    for (size_t i = 1; i < stride; ++i) {
      const int a = i > 3 ? bytes[i - 3] : 0;
      const int b = row > 0 ? *(bytes + i - stride) : 0;
      const int c = row > 0 && i > 3 ? *(bytes + i - 3 - stride) : 0;
      const int predictions[] = {0, a, b, (a + b) / 2, Paeth(a, b, c)};
      bytes[i] = static_cast<uint8_t>(bytes[i] + predictions[bytes[0]]);
      pixels[row * width + (i - 1) / 3][(i - 1) % 3] = bytes[i];
    }
  }
  return pixels;
}

TEST(EncodePngTest, KeepsEveryPixel) {
  Random random(3);
  for (const int width : {1, 2, 7, 64}) {
    for (const int height : {1, 5, 33}) {
      ColorImage image{width, height, {}};
      for (int i = 0; i < width * height; ++i) {
        const auto noise = static_cast<uint8_t>(255 * random.Unit());
        const auto ramp = static_cast<uint8_t>(3 * (i % width) + i / width);
        // Rows of noise between smooth ones, so that filters change.
        image.pixels.push_back(i / width % 3 == 0 ? Color{noise, 255, 0}
                                                  : Color{ramp, ramp, noise});
      }
      const std::string png = EncodePng(image);
      ASSERT_TRUE(png.starts_with("\x89PNG\r\n\x1a\n"));
      const std::string header = ChunkData(png, "IHDR");
      EXPECT_EQ(BigEndian(header, 0), width);
      EXPECT_EQ(BigEndian(header, 4), height);
      EXPECT_EQ(Decode(png, width, height), image.pixels);
      EXPECT_EQ(png, EncodePng(image));
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

}  // namespace encode_png_test
}  // namespace colmap_ext
