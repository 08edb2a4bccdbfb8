#include <stdexcept>

#include <gtest/gtest.h>

#include "photometry/image_pyramid.h"
#include "tests/look_at.h"

namespace colmap_ext::resized_images_test {

View ViewOfSize(int width, int height) {
  return LookAt({1, 2, 3}, {0, 0.5, 0}, width, height, 1.1 * width);
}

// 4 x 2 pixels.
ReadGrayImage Reader(std::vector<uint8_t> pixels) {
  return [=](size_t) { return GrayImage{4, 2, pixels}; };
}

TEST(ViewAtScale, ScalesTheImageAndLeavesThePose) {
  const View view = ViewOfSize(41, 29);
  EXPECT_EQ(ViewAtScale(view, 1).fx, view.fx);
  const View half = ViewAtScale(view, 0.5);
  EXPECT_EQ(half.width, 21);
  EXPECT_EQ(half.height, 15);
  const Eigen::Vector2d in_full = *PixelInImage(view, {0.1, 0.2, 0});
  const Eigen::Vector2d in_half = *PixelInImage(half, {0.1, 0.2, 0});
  EXPECT_NEAR(in_half.x() / 21, in_full.x() / 41, 1e-9);
  EXPECT_NEAR(in_half.y() / 15, in_full.y() / 29, 1e-9);
  EXPECT_EQ(ViewAtScale(view, 1e-3).height, 1);
}

TEST(ResizedImages, TakeMeansAndKeepWhatHasTheSize) {
  const View view = ViewOfSize(4, 2);
  const std::vector<uint8_t> pixels = {0, 10, 20, 30, 20, 30, 40, 50};
  const auto resized = [&](const View& to) {
    return ResizedImages(Reader(pixels), {view}, {to})(0).pixels;
  };
  EXPECT_EQ(resized(view), pixels);
  EXPECT_EQ(resized(ViewAtScale(view, 0.5)), (std::vector<uint8_t>{15, 35}));
  EXPECT_THROW(ResizedImages(Reader(pixels), {ViewOfSize(4, 3)}, {view})(0),
               std::runtime_error);
}

TEST(ResizedMasks, AreMaskedWhereAnyPixelIs) {
  const View half = ViewAtScale(ViewOfSize(4, 2), 0.5);
  const auto mask =
      ResizedMasks(Reader({255, 255, 255, 255, 255, 0, 255, 255}), {half})(0);
  EXPECT_EQ(mask.pixels, (std::vector<uint8_t>{0, 255}));
  EXPECT_FALSE(ResizedMasks({}, {half}));
  const ReadGrayImage none = [](size_t) { return GrayImage(); };
  EXPECT_TRUE(ResizedMasks(none, {half})(0).pixels.empty());
}

}  // namespace colmap_ext::resized_images_test
