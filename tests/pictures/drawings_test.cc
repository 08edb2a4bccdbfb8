#include "pictures/drawings.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "scene/look_at.h"

namespace colmap_ext {
namespace drawings_test {

TEST(ErrorColor, GoesFromOneEndOfTheScaleToTheOther) {
  EXPECT_EQ(ErrorColor(0, 2), (Color{68, 1, 84}));
  EXPECT_EQ(ErrorColor(2, 2), (Color{253, 231, 37}));
  EXPECT_EQ(ErrorColor(7, 2), ErrorColor(2, 2));
  for (int i = 0; i < 100; ++i) {  // green only grows
    EXPECT_LE(ErrorColor(i, 100)[1], ErrorColor(i + 1, 100)[1]);
  }
}

TEST(ErrorScale, IsRoundAndAboveMostErrors) {
  EXPECT_DOUBLE_EQ(ErrorScale({0.0013}), 0.002);
  EXPECT_DOUBLE_EQ(ErrorScale({30}), 50);
  EXPECT_DOUBLE_EQ(ErrorScale({7}), 10);
  EXPECT_EQ(ErrorScale({0, 0}), 1);
  EXPECT_EQ(ErrorScale({}), 1);
  std::vector<double> errors(99, 1.5);
  errors.push_back(1000);
  EXPECT_EQ(ErrorScale(errors), 2);
}

constexpr Color kWhite = {255, 255, 255};

View ViewFrom(double z) {
  return LookAtView({0, 0, z}, {0, 0, 0}, {0, 1, 0}, 64, 48, 96);
}

size_t NumDrawn(const ColorImage& image) {
  return image.pixels.size() - std::ranges::count(image.pixels, kWhite);
}

TEST(DrawPoints, HasTheNearerOfTwoPointsOnTop) {
  const PointCloud cloud = {
      {{0, 0, 0}, {0, 0, -1}}, {{10, 20, 30}, {200, 0, 0}}, {}};
  const ColorImage front = DrawPoints(cloud, ViewFrom(3), 2);
  const ColorImage back = DrawPoints(cloud, ViewFrom(-3), 2);
  EXPECT_EQ(NumDrawn(front), 4);
  EXPECT_EQ(front.At(24, 32), (Color{10, 20, 30}));
  EXPECT_EQ(back.At(24, 32), (Color{200, 0, 0}));
}

TEST(DrawPoints, CutsPointsAtTheBorderAndLeavesOutOthers) {
  const PointCloud cloud = {{{1, 0, 0}, {0, 0, 9}, {1e30f, 0, 0}}, {}, {}};
  EXPECT_EQ(NumDrawn(DrawPoints(cloud, ViewFrom(3), 4)), 8)
      << "half of the square of the first";
  EXPECT_EQ(NumDrawn(DrawPoints({}, ViewFrom(3), 4)), 0);
}

TEST(ResizePicture, TakesMeans) {
  constexpr Color kGray = {8, 8, 8};
  const std::vector<Color> pixels = {{0, 0, 0},   {100, 0, 0}, kGray, kGray,  //
                                     {100, 0, 0}, {200, 0, 0}, kGray, kGray};
  const ColorImage image{4, 2, pixels};
  const ColorImage half = ResizePicture(image, 2, 1);
  EXPECT_EQ(half.width, 2);
  EXPECT_EQ(half.height, 1);
  EXPECT_EQ(half.pixels, (std::vector<Color>{{100, 0, 0}, kGray}));
  EXPECT_EQ(ResizePicture(image, 4, 2).pixels, image.pixels);
  EXPECT_EQ(ResizePicture(image, 40, 20).At(19, 39), kGray);
}

}  // namespace drawings_test
}  // namespace colmap_ext
