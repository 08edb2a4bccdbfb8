// What only mesh_evaluator reads: depth maps and masks.

#include "formats/read_arrays.h"

#include <Eigen/Geometry>

#include "formats/read_numbers.h"
#include "tests/formats/test_files.h"

namespace colmap_ext::read_evaluation_files_test {

struct ReadEvaluationFilesTest : FolderTest {
  ReadEvaluationFilesTest() : FolderTest("a file") {}
};

TEST_F(ReadEvaluationFilesTest, ReadsADepthMap) {
  std::string bytes = "3&2&1&";
  for (int i = 0; i < 6; ++i) {
    Append(static_cast<float>(i), &bytes);
  }
  WriteFile(path_, bytes);
  const DepthMap map = ReadDepthMap(path_);
  EXPECT_EQ(map.width, 3);
  EXPECT_EQ(map.height, 2);
  EXPECT_EQ(map.depths, (std::vector<float>{0, 1, 2, 3, 4, 5}));
  ExpectEveryTruncationRefused(path_, 0, [this] { ReadDepthMap(path_); });
  for (const std::string& damaged :
       {bytes + "x", "3&2&3&" + bytes.substr(6), std::string("0&0&1&"),
        std::string("99999999&99999999&1&"), std::string("hello")}) {
    WriteFile(path_, damaged);
    EXPECT_THROW(ReadDepthMap(path_), FileError) << damaged;
  }
}

TEST_F(ReadEvaluationFilesTest, FindsDepthMapsByTheNameOfTheImage) {
  const std::filesystem::path folder = folder_.Path();
  EXPECT_TRUE(FindDepthMap(folder, "a/1.png").empty());
  for (const char* ending : {".bin", ".photometric.bin", ".geometric.bin"}) {
    const std::filesystem::path path =
        folder / "a" / (std::string("1.png") + ending);
    WriteFile(path, "");
    EXPECT_EQ(FindDepthMap(folder, "a/1.png"), path);
  }
}

// A mask of 2 x 3 x 4 voxels, numbered from 0 in its order in the file.
std::string Npy(const std::string& header) {
  std::string bytes("\x93NUMPY\x01\x00", 8);
  Append(static_cast<uint16_t>(header.size()), &bytes);
  bytes += header;
  for (uint8_t i = 0; i < 24; ++i) {
    Append(i, &bytes);
  }
  return bytes;
}

std::string Npy(const std::string& type, const std::string& fortran_order,
                const std::string& shape) {
  return Npy("{'descr': '" + type + "', 'fortran_order': " + fortran_order +
             ", 'shape': " + shape + ", }          \n");
}

TEST_F(ReadEvaluationFilesTest, ReadsAMaskInEitherOrder) {
  for (const char* type : {"|u1", "|b1", "|i1"}) {
    WriteFile(path_, Npy(type, "False", "(2, 3, 4)"));
    const VoxelGrid mask = ReadNpyMask(path_);
    EXPECT_EQ(mask.size, (std::array<size_t, 3>{2, 3, 4}));
    ASSERT_EQ(mask.voxels.size(), 24);
    for (size_t i = 0; i < 24; ++i) {
      EXPECT_EQ(mask.voxels[i], i);
    }
  }
  WriteFile(path_, Npy("|u1", "True", "(2, 3, 4)"));
  const VoxelGrid mask = ReadNpyMask(path_);
  for (size_t x = 0; x < 2; ++x) {
    for (size_t y = 0; y < 3; ++y) {
      for (size_t z = 0; z < 4; ++z) {
        EXPECT_EQ(mask.voxels[(x * 3 + y) * 4 + z], (z * 3 + y) * 2 + x);
      }
    }
  }
  ExpectEveryTruncationRefused(path_, 0, [this] { ReadNpyMask(path_); });
}

TEST_F(ReadEvaluationFilesTest, RefusesOtherArraysButReadsEmptyMasks) {
  for (const std::string& bytes :
       {Npy("<f8", "False", "(2, 3, 4)"), Npy("|u1", "False", "(24,)"),
        Npy("|u1", "False", "(2, 3, 5)"), Npy("|u1", "False", "(2, 3, 3)"),
        Npy("|u1", "False", "(999999, 999999, 999999)"),
        std::string("not an array at all")}) {
    WriteFile(path_, bytes);
    EXPECT_THROW(ReadNpyMask(path_), FileError);
  }
  const std::string empty = Npy("|u1", "False", "(2, 0, 4)");
  WriteFile(path_, empty.substr(0, empty.size() - 24));
  EXPECT_TRUE(ReadNpyMask(path_).voxels.empty());
}

// No header, however long, needs more of the stack.
TEST_F(ReadEvaluationFilesTest, ReadsLongHeaders) {
  const auto write = [this](const std::string& begin, const std::string& end) {
    constexpr size_t kLength = (1 << 16) - 1;
    const std::string blanks(kLength - begin.size() - end.size(), ' ');
    WriteFile(path_, Npy(begin + blanks + end));
  };
  write("{'descr':", "'|u1', 'fortran_order': False, 'shape': (2, 3, 4), }");
  EXPECT_EQ(ReadNpyMask(path_).size, (std::array<size_t, 3>{2, 3, 4}));
  write("{'descr': '|u1', 'fortran_order':", "True, 'shape': (2, 3, 4), }");
  EXPECT_EQ(ReadNpyMask(path_).voxels[12], 1) << "x is the fastest";
  write("{'descr': '|u1', 'shape':", "(2, 3, 4)");
  EXPECT_EQ(ReadNpyMask(path_).voxels[12], 12);
  write("{'descr': '|u1', 'shape':", "");
  EXPECT_THROW(ReadNpyMask(path_), FileError);
}

struct ReadRegionTest : FolderTest {
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

TEST_F(ReadRegionTest, ReadsTwoCornersOrAxes) {
  const Region region = ReadText("1 2 3\n-1, 6, 4\n");
  EXPECT_EQ(region.center, Eigen::Vector3d(0, 4, 3.5));
  EXPECT_EQ(region.half_sizes, Eigen::Vector3d(1, 2, 0.5));
  EXPECT_TRUE(region.region_from_world.isIdentity());
  // The rows of a rotation are the box's axes, as OpenMVS has them.
  const Region turned = ReadText("0 1 0 0 0 1 1 0 0  0 0 0  1 2 3");
  EXPECT_TRUE(turned.Contains(Eigen::Vector3d(2.9, 0.9, 1.9)));
  EXPECT_FALSE(turned.Contains(Eigen::Vector3d(0, 1.1, 0)));
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

}  // namespace colmap_ext::read_evaluation_files_test
