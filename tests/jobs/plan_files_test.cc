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

// A vertex a tile. Its x, and how many cells the tile has, say which it is.
Plan WriteTiles(const fs::path& folder, size_t num_tiles) {
  Plan plan;
  plan.identity = 5;
  plan.tiles.resize(num_tiles);
  PlanBlocks blocks;
  for (size_t tile = 0; tile < num_tiles; ++tile) {
    TileVertices vertices;
    vertices.positions.emplace_back(static_cast<float>(tile), 0, 0);
    vertices.observations.offsets = {0, 0};
    AddTile(vertices.positions, vertices.observations, &blocks);
    Write(VerticesFile(folder, plan.identity, tile), vertices);
    TileCut cut;
    cut.labels.known.assign(tile, 0);
    Write(CutFile(folder, plan.identity, tile), cut, {});
  }
  Write(BlocksFile(folder, plan.identity), blocks);
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
    EXPECT_EQ(vertices.ReadPositions(tile, tile + 1).at(0).x(), tile);
    EXPECT_EQ(parts.NumCells(tile), tile);
  });
}

}  // namespace plan_files_test
}  // namespace colmap_ext
