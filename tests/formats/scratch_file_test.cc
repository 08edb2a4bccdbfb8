#include "formats/scratch_file.h"

#include <filesystem>
#include <vector>

#include <gtest/gtest.h>

#include "tests/formats/test_files.h"

namespace colmap_ext {
namespace {

TEST(ScratchFile, KeepsWhatIsWrittenUnderNoName) {
  const TemporaryFolder folder;
  StoredVector<int> stored(
      [&] { return std::make_unique<ScratchFile>(folder.Path()); });
  EXPECT_TRUE(std::filesystem::is_empty(folder.Path()));
  stored.Append({1, 2, 3});
  stored.Append({});
  stored.Append({4, 5});
  stored.Set(1, 7);
  EXPECT_EQ(stored.size(), 5u);
  EXPECT_EQ(stored.Read(0, 5), std::vector<int>({1, 7, 3, 4, 5}));
  EXPECT_EQ(stored.Read(2, 4), std::vector<int>({3, 4}));
  EXPECT_EQ(stored.Read(5, 5), std::vector<int>());
  std::vector<int> all;
  stored.ForEachChunk([&](const std::vector<int>& chunk) {
    all.insert(all.end(), chunk.begin(), chunk.end());
  });
  EXPECT_EQ(all, stored.Read(0, 5));
  EXPECT_TRUE(std::filesystem::is_empty(folder.Path()));
}

TEST(ScratchFile, SaysWhereThereCanBeNone) {
  EXPECT_NE(FileErrorOf([] {
              ScratchFile("/proc");
            }).find("there can be no temporary file"),
            std::string::npos);
}

}  // namespace
}  // namespace colmap_ext
