#include "formats/read_ply.h"

#include "tests/formats/test_files.h"

namespace colmap_ext::read_visibility_test {

class ReadVisibilityTest : public FolderTest {
 protected:
  ReadVisibilityTest() : FolderTest("fused.ply.vis") {}

  static std::string Bytes(uint64_t num_points,
                           const std::vector<uint32_t>& numbers) {
    std::string bytes;
    Append(num_points, &bytes);
    for (const uint32_t number : numbers) {
      Append(number, &bytes);
    }
    return bytes;
  }

  void ExpectRefused(const std::string& bytes, size_t num_points,
                     const std::string& message) {
    WriteFile(path_, bytes);
    ExpectFileError(message, [&] { ReadVisibility(path_, num_points); });
  }

  // Three points, seen by {5, 1}, {} and {7}.
  const std::string bytes_ = Bytes(3, {2, 5, 1, 0, 1, 7});
};

TEST_F(ReadVisibilityTest, ReadsRowsAsTheyAre) {
  WriteFile(path_, bytes_);
  EXPECT_EQ(ReadVisibility(path_, 3), Visibility({0, 2, 2, 3}, {5, 1, 7}));
  ExpectEveryTruncationRefused(path_, 0, [this] { ReadVisibility(path_, 3); });
  WriteFile(path_, Bytes(2, {0, 0}));
  EXPECT_EQ(ReadVisibility(path_, 2), Visibility({0, 0, 0}, {}));
}

TEST_F(ReadVisibilityTest, RefusesTrailingBytes) {
  ExpectRefused(bytes_ + '\0', 3, "1 bytes more");
}

TEST_F(ReadVisibilityTest, SaysWhatToDoWithAnEditedCloud) {
  ExpectRefused(bytes_, 2, "is about 3 points, but the cloud has 2");
  ExpectRefused(bytes_, 2, "stereo_fusion");
}

TEST_F(ReadVisibilityTest, SaysWhatToDoWithoutAFile) {
  for (const char* text : {"no such file", "stereo_fusion"}) {
    ExpectFileError(text, [&] { ReadVisibility(path_, 2); });
  }
}

TEST_F(ReadVisibilityTest, RefusesCountsLargerThanTheFile) {
  ExpectRefused(Bytes(1, {0xffffffff, 0}), 1, "promises");
  ExpectRefused(Bytes(~uint64_t{0}, {}), SIZE_MAX, "no room");
}

}  // namespace colmap_ext::read_visibility_test
