#include "formats/read_visibility.h"

#include "tests/formats/test_files.h"

namespace colmap_ext {
namespace read_visibility_test {

class ReadVisibilityTest : public testing::Test {
 protected:
  ReadVisibilityTest() {
    Append(uint64_t{3}, &bytes_);
    for (const uint32_t number : {2, 5, 1, 0, 1, 7}) {
      Append(number, &bytes_);
    }
  }

  std::string ErrorOf(const std::string& bytes, size_t num_points) {
    WriteFile(path_, bytes);
    return FileErrorOf([&] { ReadVisibility(path_, num_points); });
  }

  TemporaryFolder folder_;
  std::filesystem::path path_ = folder_.Path() / "fused.ply.vis";
  std::string bytes_;  // three points, seen by {5, 1}, {} and {7}
};

TEST_F(ReadVisibilityTest, ReadsRowsAsTheyAre) {
  WriteFile(path_, bytes_);
  const Visibility visibility = ReadVisibility(path_, 3);
  EXPECT_EQ(visibility.offsets, (std::vector<uint64_t>{0, 2, 2, 3}));
  EXPECT_EQ(visibility.values, (std::vector<uint32_t>{5, 1, 7}));
}

TEST_F(ReadVisibilityTest, ReadsPointsWithoutImages) {
  std::string bytes;
  Append(uint64_t{2}, &bytes);
  Append(uint64_t{0}, &bytes);
  WriteFile(path_, bytes);
  const Visibility visibility = ReadVisibility(path_, 2);
  EXPECT_EQ(visibility.offsets, (std::vector<uint64_t>{0, 0, 0}));
  EXPECT_TRUE(visibility.values.empty());
}

TEST_F(ReadVisibilityTest, RefusesEveryTruncation) {
  WriteFile(path_, bytes_);
  ExpectEveryTruncationRefused(path_, 0, [this] { ReadVisibility(path_, 3); });
}

TEST_F(ReadVisibilityTest, RefusesTrailingBytes) {
  EXPECT_NE(ErrorOf(bytes_ + '\0', 3).find("1 bytes more"), std::string::npos);
}

TEST_F(ReadVisibilityTest, SaysWhatToDoWithAnEditedCloud) {
  const std::string error = ErrorOf(bytes_, 2);
  EXPECT_NE(error.find("is about 3 points, but the cloud has 2"),
            std::string::npos);
  EXPECT_NE(error.find("stereo_fusion"), std::string::npos);
}

TEST_F(ReadVisibilityTest, SaysWhatToDoWithoutAFile) {
  const std::string error = FileErrorOf([&] { ReadVisibility(path_, 2); });
  EXPECT_NE(error.find("no such file"), std::string::npos);
  EXPECT_NE(error.find("stereo_fusion"), std::string::npos);
}

TEST_F(ReadVisibilityTest, RefusesCountsLargerThanTheFile) {
  std::string bytes;
  Append(uint64_t{1}, &bytes);
  Append(uint32_t{0xffffffff}, &bytes);
  Append(uint32_t{0}, &bytes);
  EXPECT_NE(ErrorOf(bytes, 1).find("promises"), std::string::npos);
  std::string huge;
  Append(~uint64_t{0}, &huge);
  EXPECT_NE(ErrorOf(huge, SIZE_MAX).find("no room"), std::string::npos);
}

}  // namespace read_visibility_test
}  // namespace colmap_ext
