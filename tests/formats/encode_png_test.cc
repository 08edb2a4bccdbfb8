#include "formats/picture_files.h"

#include <cstdint>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>
#include <png.h>

#include "tests/formats/test_files.h"
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

std::string PngChunk(const std::string& type, const std::string& data) {
  std::string bytes(3, '\0');
  bytes += static_cast<char>(data.size());
  return bytes + type + data + "crc!";
}

std::string Png() {
  return "\x89PNG\r\n\x1a\n" + PngChunk("IHDR", std::string(13, '\1')) +
         PngChunk("IDAT", "IEND, but not yet") + PngChunk("IEND", "");
}

// A segment with its marker and length.
std::string JpegSegment(char marker, const std::string& data) {
  std::string bytes = "\xff";
  bytes += marker;
  bytes += '\0';
  bytes += static_cast<char>(data.size() + 2);
  return bytes + data;
}

// With a thumbnail, which has an end marker of its own.
std::string Jpeg() {
  return "\xff\xd8" + JpegSegment('\xe1', "Exif \xff\xd8 ... \xff\xd9") +
         JpegSegment('\xc0', std::string(15, '\1')) +
         JpegSegment('\xda', std::string(10, '\1')) + "data \xff" +
         std::string(1, '\0') + "\xd9 data\xff\xd9";
}

struct PictureSizeTest : FolderTest {
  PictureSizeTest() : FolderTest("picture") {}

  bool IsCutOff(const std::string& bytes) {
    WriteFile(path_, bytes);
    return IsPictureCutOff(path_);
  }
};

TEST_F(PictureSizeTest, IsReadFromTheHeader) {
  const std::string png("\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\1\2\0\0\0\7", 24);
  const std::string jpeg(
      "\xff\xd8\xff\xe0\0\4ab\xff\xff\xc4\0\3x\xff\xc2\0\x11\x08\0\5\1\1", 23);
  for (const auto& [bytes, width, height] :
       {std::tuple(png, 258, 7), std::tuple(jpeg, 257, 5)}) {
    WriteFile(path_, bytes);
    EXPECT_EQ(ReadPictureSize(path_)->width, width);
    EXPECT_EQ(ReadPictureSize(path_)->height, height);
    for (size_t size = 0; size < bytes.size(); ++size) {
      WriteFile(path_, bytes.substr(0, size));
      EXPECT_FALSE(ReadPictureSize(path_)) << size;
    }
  }
  EXPECT_FALSE(ReadPictureSize(folder_.Path() / "none"));
  EXPECT_FALSE(ReadPictureSize(folder_.Path()));
}

TEST_F(PictureSizeTest, EveryCutIsFoundButOtherFilesAreNotCut) {
  for (const std::string& bytes : {Png(), Jpeg()}) {
    EXPECT_FALSE(IsCutOff(bytes));
    EXPECT_FALSE(IsCutOff(bytes + "whatever follows"));
    for (size_t size = 8; size < bytes.size(); ++size) {
      EXPECT_TRUE(IsCutOff(bytes.substr(0, size))) << size;
    }
  }
  EXPECT_FALSE(IsCutOff("P6\n3 1\n255\n123"));
  EXPECT_FALSE(IsCutOff(""));
  EXPECT_FALSE(IsPictureCutOff(folder_.Path() / "none"));
  EXPECT_FALSE(IsPictureCutOff(folder_.Path()));
}

}  // namespace colmap_ext::encode_png_test
