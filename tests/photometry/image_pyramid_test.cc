#include "photometry/image_pyramid.h"

#include <array>
#include <atomic>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>
#include <Eigen/LU>

#include "tests/look_at.h"
#include "tests/random.h"
#include "tests/raster/pixels.h"
#include "tests/texts.h"

namespace colmap_ext::image_pyramid_test {

View ViewOfSize(int width, int height) {
  View view = LookAt({1, 2, 3}, {0, 0.5, 0}, width, height, 1.1 * width);
  view.fy *= 1.05;
  view.cx += 1.7;
  view.cy -= 2.3;
  return view;
}

// Of smooth waves, by the direction that each pixel's centre looks to.
GrayImage SmoothImage(const View& view) {
  GrayImage image{view.width, view.height, {}};
  ForEachPixel(view, [&](int row, int col) {
    const Eigen::Vector3f ray = RayDirection(view, col + 0.5, row + 0.5);
    const float wave = std::sin(9 * ray.x()) + std::cos(8 * ray.y() + 1);
    image.pixels.push_back(static_cast<uint8_t>(std::lround(127 + 60 * wave)));
  });
  return image;
}

GrayImage RandomImage(const View& view, Random* random) {
  GrayImage image{view.width, view.height, {}};
  ForEachPixel(view, [&](int, int) {
    image.pixels.push_back(static_cast<uint8_t>(random->Below(256)));
  });
  return image;
}

GrayImage ConstantImage(int width, int height, uint8_t gray) {
  return {width, height, std::vector<uint8_t>(width * height, gray)};
}

GrayImage AtLevel(const View& view, const GrayImage& image, int level) {
  ImagePyramid pyramid(
      {view}, [&](size_t) { return image; }, SIZE_MAX);
  pyramid.SetLevel(level);
  return *pyramid.Image(0);
}

TEST(ViewsAtLevel, HaveHalfTheSizeRoundedUp) {
  Random random(1);
  for (int trial = 0; trial < 50; ++trial) {
    const View view =
        ViewOfSize(random.Integer(1, 3000), random.Integer(1, 3000));
    View halved = view;
    for (int level = 0; level < 8; ++level) {
      const View at_level = ViewsAtLevel({view}, level)[0];
      EXPECT_EQ(at_level.width, std::ceil(std::ldexp(view.width, -level)));
      EXPECT_EQ(at_level.height, std::ceil(std::ldexp(view.height, -level)));
      EXPECT_EQ(at_level.width, halved.width);
      EXPECT_EQ(at_level.height, halved.height);
      EXPECT_TRUE(at_level.PixelFromRay().isApprox(halved.PixelFromRay()));
      halved = ViewsAtLevel({halved}, 1)[0];
    }
  }
}

TEST(ImagePyramid, LeavesConstantImagesConstant) {
  for (const auto& [width, height] :
       {std::pair(64, 48), {61, 47}, {1, 1}, {3, 200}}) {
    for (const uint8_t gray : {0, 1, 128, 255}) {
      const View view = ViewOfSize(width, height);
      for (const int level : {1, 2, 3}) {
        const View at_level = ViewsAtLevel({view}, level)[0];
        const GrayImage image =
            AtLevel(view, ConstantImage(width, height, gray), level);
        EXPECT_EQ(image.width, at_level.width);
        EXPECT_EQ(image.height, at_level.height);
        EXPECT_EQ(image.pixels,
                  ConstantImage(image.width, image.height, gray).pixels);
      }
    }
  }
}

TEST(ImagePyramid, TakesMeansOfWhatAPixelCovers) {
  Random random(2);
  const View view = ViewOfSize(32, 24);
  const GrayImage image = RandomImage(view, &random);
  for (const int level : {0, 1, 2, 3}) {
    const int size = 1 << level;
    const GrayImage small = AtLevel(view, image, level);
    ForEachPixel(small, [&](int row, int col) {
      double sum = 0;
      for (int y = size * row; y < size * (row + 1); ++y) {
        const uint8_t* line = image.Row(y) + size * col;
        sum += std::accumulate(line, line + size, 0.0);
      }
      EXPECT_NEAR(small.Row(row)[col], sum / (size * size), 0.501);
    });
  }
}

// By how much a picture is shifted against another, px, by least squares.
Eigen::Vector2d Shift(const GrayImage& image, const GrayImage& reference) {
  Eigen::Matrix2d matrix = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  for (int row = 1; row + 1 < image.height; ++row) {
    for (int col = 1; col + 1 < image.width; ++col) {
      const uint8_t* line = reference.Row(row) + col;
      const Eigen::Vector2d slope(
          (line[1] - line[-1]) / 2.0,
          (line[reference.width] - line[-reference.width]) / 2.0);
      matrix += slope * slope.transpose();
      right += slope * (image.Row(row)[col] - line[0]);
    }
  }
  return -matrix.inverse() * right;
}

// Whatever the size, a pixel shows what lies along the ray of its view.
TEST(ImagePyramid, ShowsTheSameAtTheSamePlace) {
  for (const auto& [width, height] : {std::pair(256, 192), {247, 190}}) {
    const View view = ViewOfSize(width, height);
    const GrayImage image = SmoothImage(view);
    for (const int level : {1, 2}) {
      const GrayImage expected = SmoothImage(ViewsAtLevel({view}, level)[0]);
      const GrayImage resized = AtLevel(view, image, level);
      ASSERT_EQ(resized.pixels.size(), expected.pixels.size());
      for (size_t i = 0; i < expected.pixels.size(); ++i) {
        EXPECT_NEAR(resized.pixels[i], expected.pixels[i], 2);
      }
      EXPECT_LT(Shift(resized, expected).norm(), 0.04);
    }
  }
}

// A lens shows at x + e(x) what a pinhole camera shows at x.
TEST(ImagePyramid, ShowsWhatAPinholeCameraWould) {
  const View view = ViewOfSize(256, 192);
  RadialShifts lens{};
  for (size_t k = 1; k < lens.size(); ++k) {
    lens[k] = 0.9 * std::sin(0.4 * static_cast<double>(k)) / HalfDiagonal(view);
  }
  RadialShifts inverse = lens;
  for (double& shift : inverse) {
    shift = -shift;
  }
  const GrayImage image = SmoothImage(view);
  const auto through = [&](const GrayImage& from, const RadialShifts& shifts) {
    ImagePyramid pyramid(
        {view}, [&](size_t) { return from; }, SIZE_MAX);
    EXPECT_EQ(pyramid.Image(0)->pixels, from.pixels);
    pyramid.CorrectLenses({shifts});
    const GrayImage shown = *pyramid.Image(0);
    pyramid.CorrectLenses({});
    EXPECT_EQ(pyramid.Image(0)->pixels, from.pixels);
    return shown;
  };
  const auto difference = [&](const GrayImage& a) {
    double sum = 0;
    for (int row = 8; row < a.height - 8; ++row) {
      for (int col = 8; col < a.width - 8; ++col) {
        sum += std::abs(a.At(row, col) - image.At(row, col));
      }
    }
    return sum;
  };
  const GrayImage shifted = through(image, inverse);
  EXPECT_LT(difference(through(shifted, lens)), 0.2 * difference(shifted));
}

struct ImagePyramidMemoryTest : testing::Test {
  static constexpr size_t kSize = 64;  // of an image, bytes

  ImagePyramid MakePyramid(size_t max_memory, size_t max_borrowed = 0,
                           const ReadGrayImage& read_mask = {}) {
    return {std::vector<View>(3, ViewOfSize(8, 8)),
            [this](size_t view) {
              ++num_reads_[view];
              return ConstantImage(8, 8, static_cast<uint8_t>(view));
            },
            max_memory, read_mask, max_borrowed};
  }

  // Each view in turn, five times.
  static void UseAll(ImagePyramid* pyramid) {
    for (int i = 0; i < 5 * 3; ++i) {
      EXPECT_EQ(pyramid->Image(i % 3)->pixels[0], i % 3);
      pyramid->Mask(i % 3);
    }
  }

  void ExpectReads(int first, int second, int third) const {
    EXPECT_EQ(num_reads_[0], first);
    EXPECT_EQ(num_reads_[1], second);
    EXPECT_EQ(num_reads_[2], third);
  }

  std::array<std::atomic<int>, 3> num_reads_ = {};
};

TEST_F(ImagePyramidMemoryTest, KeepsWhatIsInUse) {
  ImagePyramid pyramid = MakePyramid(1);
  const auto image = pyramid.Image(0);
  pyramid.Image(1);
  pyramid.SetLevel(2);
  EXPECT_EQ(image->pixels, std::vector<uint8_t>(kSize, 0));
}

TEST_F(ImagePyramidMemoryTest, ReadsOnceForAllLevelsWhereThereIsRoom) {
  // At level 1 an image takes a quarter more.
  ImagePyramid pyramid = MakePyramid(3 * kSize + 3 * kSize / 4);
  for (const int level : {2, 1, 1, 0, 1}) {
    pyramid.SetLevel(level);
    EXPECT_EQ(pyramid.Level(), level);
    for (const size_t view : {0, 1, 2, 0}) {
      EXPECT_EQ(pyramid.Image(view)->width, 8 >> level);
      EXPECT_EQ(pyramid.Views()[view].width, 8 >> level);
    }
  }
  ExpectReads(1, 1, 1);
  pyramid.SetLevel(0);
  EXPECT_EQ(pyramid.Views()[0].PixelFromRay(), ViewOfSize(8, 8).PixelFromRay());
}

// Those of the level are used again and again.
TEST_F(ImagePyramidMemoryTest, TheLevelComesBeforeTheFullSize) {
  ImagePyramid pyramid = MakePyramid(3 * kSize / 4);
  pyramid.SetLevel(1);
  UseAll(&pyramid);
  ExpectReads(1, 1, 1);
}

// All of a level or nothing: the few that would be kept more do not pay.
TEST_F(ImagePyramidMemoryTest, BorrowsWhatKeepsAllImagesOfALevel) {
  ImagePyramid pyramid = MakePyramid(kSize / 2, kSize / 4);
  EXPECT_EQ(pyramid.BorrowedMemory(), 0);
  pyramid.SetLevel(1);
  EXPECT_EQ(pyramid.BorrowedMemory(), kSize / 4);
  UseAll(&pyramid);
  ExpectReads(1, 1, 1);
  pyramid.SetLevel(0);
  EXPECT_EQ(pyramid.BorrowedMemory(), 0);
  pyramid.SetLevel(2);
  EXPECT_EQ(pyramid.BorrowedMemory(), 0);
}

TEST_F(ImagePyramidMemoryTest, MasksShareTheMemory) {
  int num_mask_reads = 0;
  ImagePyramid pyramid = MakePyramid(kSize, 5 * kSize, [&](size_t) {
    ++num_mask_reads;
    return ConstantImage(8, 8, 255);
  });
  EXPECT_EQ(pyramid.BorrowedMemory(), 5 * kSize);
  UseAll(&pyramid);
  ExpectReads(1, 1, 1);
  EXPECT_EQ(num_mask_reads, 3);
}

// Whatever was kept of other levels.
TEST(ImagePyramid, LevelsComeFromTheFullSize) {
  Random random(3);
  const View view = ViewOfSize(61, 47);
  const GrayImage image = RandomImage(view, &random);
  for (const size_t max_memory : {size_t{0}, size_t{3000}, SIZE_MAX}) {
    ImagePyramid pyramid(
        {view}, [&](size_t) { return image; }, max_memory);
    for (const int level : {3, 1, 2, 0, 3, 2}) {
      pyramid.SetLevel(level);
      EXPECT_EQ(pyramid.Image(0)->pixels, AtLevel(view, image, level).pixels);
    }
  }
}

TEST_F(ImagePyramidMemoryTest, IsSafeFromSeveralThreads) {
  for (const size_t max_memory : {size_t{1}, SIZE_MAX}) {
    for (const int level : {0, 1}) {
      for (std::atomic<int>& count : num_reads_) {
        count = 0;
      }
      ImagePyramid pyramid = MakePyramid(max_memory);
      pyramid.SetLevel(level);
      std::atomic<int> num_wrong = 0;
      tbb::parallel_for(0, 300, [&](int i) {
        const size_t view = i % 3;
        num_wrong += pyramid.Image(view)->pixels[0] != view;
      });
      EXPECT_EQ(num_wrong, 0);
      for (const std::atomic<int>& count : num_reads_) {
        EXPECT_TRUE(max_memory == 1 || count == 1) << count;
      }
    }
  }
}

TEST(ImagePyramid, RefusesImagesOfAnotherSize) {
  for (const auto& [width, height] : {std::pair(10, 9), {9, 10}}) {
    View view = ViewOfSize(10, 10);
    view.name = "changed.jpg";
    ImagePyramid pyramid(
        {view},
        [width = width, height = height](size_t) {
          return ConstantImage(width, height, 0);
        },
        SIZE_MAX);
    EXPECT_TRUE(Has(MessageOf<std::runtime_error>([&] { pyramid.Image(0); }),
                    "changed.jpg"));
  }
}

// A pixel of a level is masked where any that it covers is.
TEST(ImagePyramid, HalvesMasks) {
  const View view = ViewOfSize(37, 21);
  GrayImage mask = ConstantImage(37, 21, 255);
  Random random(3);
  for (int i = 0; i < 20; ++i) {
    mask.pixels[random.Below(37 * 21)] = 0;
  }
  ImagePyramid pyramid({view, view}, {}, SIZE_MAX,
                       [&](size_t i) { return i == 0 ? mask : GrayImage(); });
  EXPECT_FALSE(pyramid.Mask(1));
  EXPECT_EQ(pyramid.Mask(0)->pixels, mask.pixels);
  for (const int level : {1, 2}) {
    pyramid.SetLevel(level);
    const GrayImage& halved = *pyramid.Mask(0);
    ASSERT_EQ(halved.width, pyramid.Views()[0].width);
    const double scale_x = 37.0 / halved.width;
    const double scale_y = 21.0 / halved.height;
    ForEachPixel(halved, [&](int row, int col) {
      bool is_masked = false;
      for (int y = 0; y < 21; ++y) {
        for (int x = 0; x < 37; ++x) {
          is_masked |= mask.Row(y)[x] == 0 && x + 1 > col * scale_x + 0.02 &&
                       x < (col + 1) * scale_x - 0.02 &&
                       y + 1 > row * scale_y + 0.02 &&
                       y < (row + 1) * scale_y - 0.02;
        }
      }
      EXPECT_EQ(halved.Row(row)[col], is_masked ? 0 : 255);
    });
  }
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

}  // namespace colmap_ext::image_pyramid_test
