#include "colmap_ext/jobs/plan_files.h"

#include <sys/resource.h>

#include <tbb/parallel_for.h>

#include "tests/formats/test_files.h"

namespace colmap_ext {
namespace plan_files_test {

namespace fs = std::filesystem;

// Lets this process open fewer files, as long as it lives.
class OpenFilesLimit {
 public:
  explicit OpenFilesLimit(rlim_t max_files) {
    getrlimit(RLIMIT_NOFILE, &before_);
    const rlimit limit = {max_files, before_.rlim_max};
    setrlimit(RLIMIT_NOFILE, &limit);
  }
  ~OpenFilesLimit() { setrlimit(RLIMIT_NOFILE, &before_); }
  OpenFilesLimit(const OpenFilesLimit&) = delete;
  OpenFilesLimit& operator=(const OpenFilesLimit&) = delete;

 private:
  rlimit before_ = {};
};

// Tiles that are the same again after so many.
constexpr size_t kPeriod = 8;

// A vertex a tile. Its x, and how many cells the tile has, say which it is.
Plan WriteTiles(const fs::path& folder, size_t num_tiles) {
  Plan plan;
  plan.identity = 5;
  plan.tiles.resize(num_tiles);
  PlanBlocks blocks;
  for (size_t tile = 0; tile < num_tiles; ++tile) {
    const size_t number = tile % kPeriod;
    TileVertices vertices;
    vertices.positions.emplace_back(static_cast<float>(number), 0, 0);
    vertices.observations.offsets = {0, 0};
    AddTile(vertices.positions, vertices.observations, &blocks);
    if (tile == number) {
      WriteVertices(folder, plan.identity, tile, vertices);
      TileCut cut;
      cut.labels.known.assign(number, 0);
      WriteCut(folder, plan.identity, tile, cut, {});
    } else {
      fs::create_hard_link(VerticesPath(folder, number),
                           VerticesPath(folder, tile));
      fs::create_hard_link(CutPath(folder, number), CutPath(folder, tile));
    }
  }
  WriteBlocks(folder, plan.identity, blocks);
  return plan;
}

TEST(PlanFiles, APlanMayHaveMoreTilesThanOpenFiles) {
  constexpr uint32_t kNumTiles = 400;
  const TemporaryFolder folder;
  const Plan plan = WriteTiles(folder.Path(), kNumTiles);
  const OpenFilesLimit limit(350);
  const FilePlan vertices(folder.Path(), plan);
  const FileParts parts(folder.Path(), plan);
  tbb::parallel_for(uint32_t{0}, kNumTiles, [&](uint32_t i) {
    const uint32_t tile = i * 7 % kNumTiles;
    EXPECT_EQ(vertices.ReadPositions(tile, tile + 1).at(0).x(), tile % kPeriod);
    EXPECT_EQ(parts.NumCells(tile), tile % kPeriod);
  });
}

}  // namespace plan_files_test
}  // namespace colmap_ext
