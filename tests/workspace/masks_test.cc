#include "workspace/read_pictures.h"

#include <algorithm>

#include "scene/view.h"
#include "tests/workspace/sphere_workspace.h"

namespace colmap_ext::masks_test {

constexpr int kWidth = 40;
constexpr int kHeight = 30;

// The left half is masked.
std::string HalfMask() {
  std::string mask = "P5\n40 30\n255\n";
  for (int i = 0; i < kWidth * kHeight; ++i) {
    mask += static_cast<char>(i % kWidth < kWidth / 2 ? 0 : 7);
  }
  return mask;
}

struct MasksTest : FolderTest {
  MasksTest() {
    for (const char* name : {"a/1.jpg", "2.png", "3.jpg"}) {
      View view =
          LookAtView({0, 0, -10}, {0, 0, 0}, {0, -1, 0}, kWidth, kHeight, 50);
      view.name = name;
      views_.push_back(view);
    }
    std::filesystem::create_directories(masks_ / "a");
  }

  ReadGrayImage Reader() const {
    return MaskReader(masks_, views_, NetpbmDecoder());
  }

  // Points in the left and in the right half of the images.
  PointCloud Cloud() const {
    PointCloud cloud;
    const Eigen::Vector3d left =
        Eigen::Vector3d(views_[0].RayFromPixel() * Eigen::Vector3d(5, 15, 1));
    const double side = left.x() < 0 ? -1 : 1;
    for (int i = 0; i < 6; ++i) {
      cloud.positions.emplace_back(i % 2 == 0 ? side : -side, 0.1 * i, 0);
      cloud.colors.push_back({static_cast<uint8_t>(i), 0, 0});
      cloud.views.AddRow(std::vector<uint32_t>{0, 2});
    }
    cloud.views.values.back() = 1;
    return cloud;
  }

  std::filesystem::path masks_ = path_ / "masks";
  std::vector<View> views_;
};

TEST_F(MasksTest, AreFoundByColmapsNames) {
  WriteFile(masks_ / "a" / "1.jpg.png", HalfMask());
  WriteFile(masks_ / "2.png", HalfMask());
  WriteFile(masks_ / "3.jpg", HalfMask());
  EXPECT_EQ(FindMask(masks_, "a/1.jpg"), masks_ / "a" / "1.jpg.png");
  EXPECT_EQ(FindMask(masks_, "2.png"), masks_ / "2.png");
  EXPECT_TRUE(FindMask(masks_, "3.jpg").empty());
  WriteFile(masks_ / "2.png.png", HalfMask());
  EXPECT_EQ(FindMask(masks_, "2.png"), masks_ / "2.png.png");
}

TEST_F(MasksTest, AreReadAtTheSizeOfTheirImages) {
  WriteFile(masks_ / "a" / "1.jpg.png", HalfMask());
  const ReadGrayImage read = Reader();
  const GrayImage mask = read(0);
  ASSERT_EQ(mask.width, kWidth);
  EXPECT_EQ(mask.Row(3)[kWidth / 2 - 1], 0);
  EXPECT_EQ(mask.Row(3)[kWidth / 2], 255);
  EXPECT_TRUE(read(1).pixels.empty());
  for (const char* damaged : {"P5\n2 1\n255\nab", "no picture"}) {
    WriteFile(masks_ / "a" / "1.jpg.png", damaged);
    ExpectFileError("1.jpg.png", [&] { read(0); });
  }
}

TEST_F(MasksTest, AFolderWithoutMasksIsRefused) {
  ExpectFileError("a/1.jpg.png", [&] { Reader(); });
  masks_ = path_ / "nothing";
  ExpectFileError("nothing", [&] { Reader(); });
}

TEST_F(MasksTest, PointsLoseMaskedViewsAndThoseWithoutViewsAreDropped) {
  WriteFile(masks_ / "a" / "1.jpg.png", HalfMask());
  PointCloud cloud = Cloud();
  EXPECT_EQ(MaskCloud(Reader(), views_, &cloud).num_masked_observations, 3u);
  ASSERT_EQ(cloud.size(), 6u);
  EXPECT_TRUE(std::ranges::equal(cloud.views[0], std::vector<uint32_t>{2}));
  WriteFile(masks_ / "3.jpg.png", HalfMask());
  cloud = Cloud();
  const MaskReport report = MaskCloud(Reader(), views_, &cloud);
  EXPECT_EQ(report.num_masks, 2u);
  // Three points are in the right half of both images.
  ASSERT_EQ(cloud.size(), 3u);
  EXPECT_EQ(report.num_masked_points, 3u);
  EXPECT_EQ(report.num_masked_observations, 6u);
  for (size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(cloud.colors[i][0], 2 * i + 1);
    EXPECT_EQ(cloud.views[i].size(), 2u);
  }
}

TEST_F(MasksTest, KeptMasksAreReadOnceAndStayAsTheyAre) {
  WriteFile(masks_ / "2.png", HalfMask());
  for (const size_t max_memory : {size_t{0}, size_t{1000}}) {
    size_t num_reads = 0;
    const ReadGrayImage keep = KeepMasks(
        [&](size_t view) {
          ++num_reads;
          return Reader()(view);
        },
        views_, max_memory);
    for (const size_t view : {1, 2, 1, 2}) {
      const GrayImage mask = keep(view);
      EXPECT_EQ(mask.width, Reader()(view).width);
      EXPECT_EQ(mask.height, Reader()(view).height);
      EXPECT_EQ(mask.pixels, Reader()(view).pixels);
    }
    EXPECT_EQ(num_reads, max_memory > 0 ? 2u : 4u);
  }
}

}  // namespace colmap_ext::masks_test
