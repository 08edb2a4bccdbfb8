
#include <Eigen/Geometry>

#include "formats/read_numbers.h"
#include "tests/formats/test_files.h"

namespace colmap_ext::read_numbers_test {

class ReadRegionTest : public FolderTest {
 protected:
  ReadRegionTest() : FolderTest("region.txt") {}

  Region ReadText(const std::string& text) {
    WriteFile(path_, text);
    return ReadRegion(path_);
  }
};

TEST(ParseNumbersTest, TakesBlanksCommasAndComments) {
  EXPECT_EQ(ParseNumbers("1, -2.5e1\n# 3\n+4\t5 # 6"),
            (std::vector<double>{1, -25, 4, 5}));
  EXPECT_EQ(ParseNumbers(""), std::vector<double>());
  for (const char* text : {"1 a", "1x", "nan", "inf", "1 2 0x3", "1..2"}) {
    EXPECT_FALSE(ParseNumbers(text)) << text;
  }
}

TEST_F(ReadRegionTest, ReadsTwoCorners) {
  const Region region = ReadText("1 2 3\n-1, 6, 4\n");
  EXPECT_EQ(region.center, Eigen::Vector3d(0, 4, 3.5));
  EXPECT_EQ(region.half_sizes, Eigen::Vector3d(1, 2, 0.5));
  EXPECT_TRUE(region.region_from_world.isIdentity());
}

TEST_F(ReadRegionTest, ReadsWhatItWrites) {
  const Region region{
      Eigen::Quaterniond(0.3, 0.1, -0.5, 0.8).normalized().toRotationMatrix(),
      {1e-3, 2e5, -3.3},
      {1, 2, 3}};
  const Region read = ReadText(RegionText(region));
  EXPECT_TRUE(read.region_from_world.isApprox(region.region_from_world, 1e-15));
  EXPECT_EQ(read.center, region.center);
  EXPECT_EQ(read.half_sizes, region.half_sizes);
}

// The rows of a rotation are the box's axes, as OpenMVS has them.
TEST_F(ReadRegionTest, RowsAreTheAxes) {
  const Region region = ReadText("0 1 0 0 0 1 1 0 0  0 0 0  1 2 3");
  EXPECT_TRUE(region.Contains(Eigen::Vector3d(2.9, 0.9, 1.9)));
  EXPECT_FALSE(region.Contains(Eigen::Vector3d(0, 1.1, 0)));
}

TEST_F(ReadRegionTest, RefusesWhatIsNoBox) {
  for (const char* text :
       {"", "1 2 3", "1 2 3 4 5 6 7", "1 2 3 1 5 6", "hello",
        "1 0 0 0 1 0 0 0 2  0 0 0  1 1 1", "1 0 0 0 1 0 0 0 1  0 0 0  1 1 0",
        "1 0 0 0 1 0 0 0 1  0 0 0  1 1 -1"}) {
    WriteFile(path_, text);
    EXPECT_THROW(ReadRegion(path_), FileError) << text;
  }
  WriteFile(path_, std::string(1 << 17, ' ') + "0 0 0 1 1 1");
  EXPECT_THROW(ReadRegion(path_), FileError);
  EXPECT_THROW(ReadRegion(folder_.Path() / "missing"), FileError);
  EXPECT_THROW(ReadRegion(folder_.Path()), FileError);
}

TEST(ParseCornersTest, TakesSixNumbersOnly) {
  EXPECT_TRUE(ParseCorners("0,0,0,1,1,1"));
  for (const char* text : {"", "auto", "0,0,0,1,1", "0,0,0,1,1,0", "a.txt"}) {
    EXPECT_FALSE(ParseCorners(text)) << text;
  }
}

}  // namespace colmap_ext::read_numbers_test
