#include "colmap_ext/jobs/mesh_tiles.h"

#include <sys/resource.h>

#include <map>
#include <mutex>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include "colmap_ext/jobs/job_file.h"
#include "colmap_ext/jobs/plan.h"
#include "colmap_ext/jobs/plan_files.h"
#include "colmap_ext/jobs/refinement_estimate.h"
#include "colmap_ext/jobs/refinement_input.h"
#include "tests/workspace/sphere_workspace.h"

namespace colmap_ext::make_plan_test {

namespace fs = std::filesystem;

struct MakePlanTest : testing::Test {
  MakePlanTest() {
    sphere_.Write(workspace_);
    options_.mesher.workspace_path = workspace_.string();
    options_.output_path = plan_.string();
    options_.num_tiles = 3;
  }

  SphereWorkspace sphere_;
  TemporaryFolder folder_;
  fs::path workspace_ = folder_.Path() / "workspace";
  fs::path plan_ = folder_.Path() / "plan";
  PlannerOptions options_;
  PlanReport report_;
};

TEST_F(MakePlanTest, ADamagedPlanIsMadeAgain) {
  options_.Finish();
  MakePlan(options_, NetpbmDecoder(), {}, &report_);
  EXPECT_FALSE(report_.is_kept);
  const auto files = FilesOf(plan_);
  MakePlan(options_, NetpbmDecoder(), {}, &report_);
  EXPECT_TRUE(report_.is_kept);
  for (const char* name : {"blocks.bin", "plan.json"}) {
    const std::string bytes = ReadFile(plan_ / name);
    for (const size_t at : {size_t{0}, bytes.size() / 3, bytes.size() - 3}) {
      std::string damaged = bytes;
      damaged[at] = static_cast<char>(damaged[at] ^ 1);
      for (const std::string& other : {damaged, bytes.substr(0, at)}) {
        WriteFile(plan_ / name, other);
        PlanReport report;
        MakePlan(options_, NetpbmDecoder(), {}, &report);
        EXPECT_FALSE(report.is_kept) << name << " " << at;
        EXPECT_TRUE(FilesOf(plan_) == files) << name << " " << at;
      }
    }
  }
}

TEST_F(MakePlanTest, DecodesEachMaskOnce) {
  const fs::path masks = folder_.Path() / "masks";
  for (const SphereWorkspace::Image& image : sphere_.images) {
    const View& view = image.view;
    std::string pixels(static_cast<size_t>(view.width) * view.height, '\xff');
    pixels.replace(0, pixels.size() / 4, pixels.size() / 4, '\0');
    WriteFile(masks / (view.name + ".png"),
              "P5\n" + std::to_string(view.width) + " " +
                  std::to_string(view.height) + "\n255\n" + pixels);
  }
  std::map<fs::path, int> num_decoded;
  std::mutex mutex;
  PictureDecoder decoder = NetpbmDecoder();
  decoder.read_gray = [&, read = decoder.read_gray](const fs::path& path) {
    const std::scoped_lock lock(mutex);
    ++num_decoded[path];
    return read(path);
  };
  options_.mesher.scene.mask_path = masks.string();
  options_.mesher.scene.region.text = "-0.9,-2,-2,0.9,2,2";
  options_.mesher.mask_background = true;
  options_.Finish();
  MakePlan(options_, decoder, {}, &report_);
  ASSERT_TRUE(report_.masks);
  EXPECT_EQ(report_.masks->num_masks, sphere_.images.size());
  EXPECT_GT(report_.masks->num_masked_points, 0u);
  for (const SphereWorkspace::Image& image : sphere_.images) {
    EXPECT_EQ(num_decoded[masks / (image.view.name + ".png")], 1)
        << image.view.name;
  }
}

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
  plan.folder = folder;
  plan.identity = 5;
  plan.tiles.resize(num_tiles);
  PlanBlocks blocks;
  for (size_t tile = 0; tile < num_tiles; ++tile) {
    TileVertices vertices;
    vertices.positions.emplace_back(static_cast<float>(tile), 0, 0);
    vertices.observations.offsets = {0, 0};
    AddTile(vertices.positions, vertices.observations, &blocks);
    Write(VerticesFile(plan, tile), vertices);
    TileCut cut;
    cut.labels.known.assign(tile, 0);
    Write(CutFile(plan, tile), cut, {});
  }
  Write(BlocksFile(plan), blocks);
  return plan;
}

TEST(PlanFiles, APlanMayHaveMoreTilesThanOpenFiles) {
  constexpr uint32_t kNumTiles = 400;
  const TemporaryFolder folder;
  const Plan plan = WriteTiles(folder.Path(), kNumTiles);
  const OpenFilesLimit limit(350);
  const FilePlan vertices(plan);
  const FileParts parts(plan);
  tbb::parallel_for(uint32_t{0}, kNumTiles, [&](uint32_t i) {
    const uint32_t tile = i * 7 % kNumTiles;
    EXPECT_EQ(vertices.ReadPositions(tile, tile + 1).at(0).x(), tile);
    EXPECT_EQ(parts.NumCells(tile), tile);
  });
}

struct JobInputsTest : testing::Test {
  JobInputsTest() {
    sphere_.Write(path_);
    WriteFile(path_ / "mesh.ply",
              "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
              "property float y\nproperty float z\nelement face 1\n"
              "property list uchar int vertex_index\nend_header\n"
              "1 0 0\n0 1 0\n0 0 1\n3 0 1 2\n");
  }

  JobInputs Inputs() const {
    RefinerOptions options = options_;
    options.workspace_path = path_.string();
    options.input_path = (path_ / "mesh.ply").string();
    options.output_path = (path_ / "refined.ply").string();
    options.Finish();
    const RefinementPaths paths = FindRefinementPaths(options);
    return RunInputs(options, paths,
                     ReadRefinementInput(options, paths, NetpbmDecoder(), {}));
  }

  // The name of what is no longer as it was; "" for nothing.
  std::string Changed() const {
    const std::string difference = Inputs().DifferenceTo(before_);
    return difference.substr(0, difference.find(" was "));
  }

  void ChangeByte(const std::string& name, size_t position) const {
    std::string bytes = ReadFile(path_ / name);
    bytes[position] = static_cast<char>(bytes[position] ^ 1);
    WriteFile(path_ / name, bytes);
  }

  TemporaryFolder folder_;
  fs::path path_ = folder_.Path();
  SphereWorkspace sphere_;
  RefinerOptions options_;
  JobInputs before_;
};

TEST_F(JobInputsTest, TellsWhichFileWasChanged) {
  const std::string picture = "images/" + sphere_.images[2].view.name;
  for (const auto& [name, position] :
       {std::pair<std::string, size_t>("sparse/cameras.bin", 32),
        std::pair<std::string, size_t>("sparse/images.bin", 44),
        std::pair<std::string, size_t>("sparse/points3D.bin", 16),
        std::pair<std::string, size_t>("fused.ply", 300),
        std::pair<std::string, size_t>(picture, 100)}) {
    before_ = Inputs();
    EXPECT_EQ(Changed(), "");
    ChangeByte(name, position);
    EXPECT_EQ(Changed(), name);
  }
}

TEST_F(JobInputsTest, TellsTheOptionThatWasChanged) {
  before_ = Inputs();
  options_.refinement.smoothness_weight = 0.1 + 0.2;
  EXPECT_EQ(Changed(), "FacetwiseRefinement.smoothness_weight");
  options_.refinement.smoothness_weight = 1;
  options_.max_memory_gb = 1;
  EXPECT_EQ(Changed(), "") << "this does not change the result";
}

// Files of more than 16 MB are sampled, their ends included.
TEST(FingerprintTest, TellsFilesApart) {
  const TemporaryFolder folder;
  const fs::path path = folder.Path() / "file";
  EXPECT_EQ(Fingerprint(path), "none");
  for (const size_t size : {0, 1, 1 << 18, (16 << 20) + 1, 40 << 20}) {
    std::string bytes(size, 'a');
    WriteFile(path, bytes);
    const std::string fingerprint = Fingerprint(path);
    EXPECT_EQ(fingerprint.substr(0, fingerprint.find(' ')),
              std::to_string(size));
    EXPECT_EQ(Fingerprint(path), fingerprint);
    for (const double share : {0.0, 1.0}) {
      if (size > 0) {
        const auto at =
            static_cast<size_t>(share * static_cast<double>(size - 1));
        bytes[at] = 'b';
        WriteFile(path, bytes);
        EXPECT_NE(Fingerprint(path), fingerprint) << size << " " << share;
        bytes[at] = 'a';
      }
    }
  }
}

std::vector<View> Views(size_t count) {
  return std::vector<View>(count, View{"", 4000, 3000});
}

RefinementTile Estimate(size_t num_views, double max_memory_gb, double facets) {
  RefinementTile tile;
  tile.facets = facets;
  EstimateRefinement(Views(num_views), max_memory_gb, 1, kBoundGbPerFacet,
                     &tile);
  return tile;
}

constexpr double kImageGb = 4000 * 3000 * 4e-9;  // and what is drawn into it

TEST(EstimateRefinement, CountsWhatEachThreadHolds) {
  for (const size_t num_views : {2, 20, 200}) {
    for (const double facets : {1e5, 1e7}) {
      const RefinementTile kept = Estimate(num_views, 1e3, facets);
      // A picture of 4 bytes a pixel that is read.
      EXPECT_GT(kept.thread_gb, 4000 * 3000 * 4e-9);
      EXPECT_GT(kept.memory_gb, kImageGb * static_cast<double>(num_views));
      // Where images are not kept, each thread has two of them.
      const RefinementTile dropped = Estimate(num_views, 1e-9, facets);
      EXPECT_NEAR(dropped.thread_gb - kept.thread_gb, 2 * kImageGb, 1e-6);
      EXPECT_LT(dropped.memory_gb, kept.memory_gb);
    }
  }
  // 2.5 times what it takes as a rule.
  EXPECT_NEAR(Estimate(2, 1e3, 2e7).memory_gb - Estimate(2, 1e3, 1e7).memory_gb,
              2.5 * kUsualGbPerFacet * 1e7, 1e-6);
}

// Images get what the mesh leaves, so that the job keeps to the limit.
TEST(EstimateRefinement, KeepsToTheLimitWhereTheMeshAllowsIt) {
  for (const double facets : {1e5, 1e6, 8e6}) {
    const RefinementTile job = Estimate(500, 16, facets);
    EXPECT_NEAR(job.memory_gb + job.thread_gb, 0.9 * 16, 1e-6) << facets;
    EXPECT_GT(Estimate(500, 1e3, facets).cache_gb, 500 * kImageGb);
  }
  // An eighth stays, however large the mesh is.
  EXPECT_EQ(Estimate(500, 16, 1e9).cache_gb, 2);
}

}  // namespace colmap_ext::make_plan_test
