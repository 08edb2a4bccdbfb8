#include "colmap_ext/colmap_compat.h"

#include <string>
#include <vector>

#include "formats/picture_files.h"
#include "tests/formats/test_files.h"

namespace colmap_ext {
namespace colmap_compat_test {

TEST(ColmapPictureDecoder, ReadsPicturesInGrey) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder.Path();
  const PictureDecoder decoder = ColmapPictureDecoder();
  WriteFile(path / "gray.pgm", std::string("P5\n3 2\n255\n\x01\x02\x03"
                                           "\x04\x05\x06"));
  const std::optional<GrayImage> image = decoder.read_gray(path / "gray.pgm");
  ASSERT_TRUE(image);
  EXPECT_EQ(image->width, 3);
  EXPECT_EQ(image->height, 2);
  EXPECT_EQ(image->pixels, (std::vector<uint8_t>{1, 2, 3, 4, 5, 6}));
  // 10 20 30, 1 2 6 and 255 255 255.
  WriteFile(path / "color.ppm",
            "P6\n3 1\n255\n\x0a\x14\x1e\x01\x02\x06\xff\xff\xff");
  const std::optional<GrayImage> color = decoder.read_gray(path / "color.ppm");
  ASSERT_TRUE(color);
  EXPECT_EQ(color->pixels, (std::vector<uint8_t>{20, 3, 255}));
  EXPECT_FALSE(decoder.read_gray(path / "none.png"));
}

TEST(ColmapPictureDecoder, ReadsOurPng) {
  const TemporaryFolder folder;
  ColorImage image{13, 7, {}};
  for (int i = 0; i < 13 * 7; ++i) {
    image.pixels.push_back({static_cast<uint8_t>(5 * i),
                            static_cast<uint8_t>(i % 13),
                            static_cast<uint8_t>(i * i)});
  }
  WritePng(folder.Path() / "a.png", image);
  const std::optional<ColorImage> read =
      ColmapPictureDecoder().read_color(folder.Path() / "a.png");
  ASSERT_TRUE(read);
  EXPECT_EQ(read->width, 13);
  EXPECT_EQ(read->pixels, image.pixels);
}

}  // namespace colmap_compat_test
}  // namespace colmap_ext
