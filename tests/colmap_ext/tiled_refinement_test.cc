// The refinement of a plan's tiles as a user runs it.

#include <sys/wait.h>

#include <algorithm>
#include <csignal>
#include <vector>

#include <nlohmann/json.hpp>

#include "formats/picture_files.h"
#include "tests/colmap_ext/refiner_fixture.h"
#include "tests/mesh/known_meshes.h"

namespace colmap_ext::tiled_refinement_test {

namespace fs = std::filesystem;

struct TiledRefinementTest : RefinerFixture {
  std::string PlanCommand(int num_tiles) const {
    return CommandLine("mesh_planner" + Workspace() +
                       PathOption("output_path", plan_) + " --num_tiles " +
                       std::to_string(num_tiles) + " ");
  }

  // Plans, meshes and merges.
  void MakePlan(int num_tiles, const std::string& more = "") const {
    fs::remove_all(plan_);
    Succeed(RunShell("cd " + Quote(folder_.Path()) + " && " +
                     PlanCommand(num_tiles) + more));
    for (int tile = 0; tile < num_tiles; ++tile) {
      RunProgram("delaunay_manifold_mesher " + Plan() + Tile(tile));
    }
    Succeed(RunProgram("mesh_merger " + Plan() +
                       PathOption("output_path", merged_)));
  }

  Outcome PlanRefinement(const std::string& more = "") const {
    return Run(Plan() + PathOption("input_path", merged_) + kEffort + more);
  }

  void RefineTiles(int num_tiles, const std::string& more = "") const {
    Succeed(PlanRefinement(more));
    for (int color = 0; color < num_tiles; ++color) {
      for (const int tile : TilesOf(color)) {
        Succeed(Run(Plan() + Tile(tile)));
      }
    }
  }

  nlohmann::json PlannedTiles() const {
    return nlohmann::json::parse(ReadFile(plan_ / "refine.json"))["tiles"];
  }

  std::vector<int> TilesOf(int color) const {
    const nlohmann::json planned = PlannedTiles();
    std::vector<int> tiles;
    for (int tile = 0; tile < static_cast<int>(planned.size()); ++tile) {
      if (planned[tile]["color"] == color) {
        tiles.push_back(tile);
      }
    }
    return tiles;
  }

  Outcome MergeRefined() const {
    return RunProgram("mesh_merger " + Plan() + " --refined 1 --output_path " +
                      Quote(refined_));
  }

  // Refines the merged mesh by its tiles.
  // \return its bytes
  std::string RefineAndMerge(int num_tiles,
                             const std::string& more = "") const {
    RefineTiles(num_tiles, more);
    Succeed(MergeRefined());
    return BytesOf(refined_);
  }

  // The same without tiles, to a file of its own.
  fs::path RefineUntiled(const std::string& options) const {
    fs::path output = folder_.Path() / "untiled.ply";
    Succeed(Refine(PathOption("input_path", merged_) +
                   PathOption("output_path", output) + kEffort +
                   " @refine_cameras none " + options));
    return output;
  }

  fs::path PatchPath(int tile) const {
    return plan_ / ("tile0000" + std::to_string(tile) + ".refined.bin");
  }

  int InterruptTile(int tile, const std::string& text, int signal) const {
    return Interrupt(Plan() + Tile(tile), text, {signal});
  }

  // Refines a tile, its patch gone.
  // \return what the job prints
  std::string RefineAgain(int tile) const {
    return Succeed(Run(Plan() + Tile(tile))).out;
  }

  // Refines two tiles, and removes the patch of the one that comes last, next
  // to what is fixed then.
  struct LastTile {
    int tile;
    std::string patch;  // its bytes
    std::string files;  // of the plan
  };
  LastTile RefineTwoTiles() const {
    MakePlan(2);
    RefineTiles(2);
    const int tile = TilesOf(1).at(0);
    LastTile last = {tile, ReadFile(PatchPath(tile)), List(plan_)};
    fs::remove(PatchPath(tile));
    return last;
  }

  std::string Plan() const { return PathOption("plan_path", plan_); }
  static std::string Tile(int tile) {
    return " --tile " + std::to_string(tile);
  }

  static constexpr const char* kEffort = " @levels 2 @iterations 3";

  fs::path plan_ = folder_.Path() / "a plan";
  fs::path merged_ = folder_.Path() / "merged.ply";
  fs::path refined_ = folder_.Path() / "refined.ply";
};

TEST_F(TiledRefinementTest, MakesAMeshWithoutSeams) {
  MakePlan(1);
  RefineAndMerge(1);
  ExpectGoodMesh(refined_);
  const double whole = Error(refined_);
  EXPECT_LT(whole, 0.9 * Error(merged_));
  for (const int num_tiles : {2, 4}) {
    MakePlan(num_tiles);
    RefineAndMerge(num_tiles);
    ExpectGoodMesh(refined_);
    EXPECT_LT(Error(refined_), 1.05 * whole) << num_tiles;
  }
}

// Before the points were fused the poses were off by a pixel.
TEST_F(TiledRefinementTest, RefinesTheCamerasOfThePlan) {
  fs::remove_all(path_);
  WriteWorkspace(MakeStatue(1), 1, path_.string());
  const fs::path sparse = plan_ / "sparse-refined";
  MakePlan(2);
  EXPECT_TRUE(Has(PlanRefinement().out, "refined, " + sparse.string()));
  RefineAndMerge(2);
  ExpectGoodMesh(refined_);
  EXPECT_TRUE(Has(MergeRefined().out, sparse.string()));
  const double error = Error(refined_);
  const std::string plan = ReadFile(plan_ / "refine.json");
  const std::string images = ReadFile(sparse / "images.bin");
  fs::remove(plan_ / "refine.json");
  fs::remove_all(sparse);
  Succeed(PlanRefinement(" @num_threads 1"));
  EXPECT_TRUE(ReadFile(plan_ / "refine.json") == plan);
  EXPECT_TRUE(ReadFile(sparse / "images.bin") == images);
  Succeed(Refine(PathOption("input_path", merged_) +
                 PathOption("output_path", refined_) + kEffort));
  EXPECT_TRUE(fs::exists(path_ / "sparse-refined"));
  EXPECT_LT(error, 1.02 * Error(refined_));
  RefineAndMerge(2, " @refine_cameras none");
  EXPECT_FALSE(fs::exists(sparse));
  EXPECT_LT(error, 0.8 * Error(refined_));
}

// The left part of each image is masked. Deep in it the images may be anything.
TEST_F(TiledRefinementTest, LeavesOutWhatIsMasked) {
  constexpr int kMasked = 70;  // columns
  constexpr int kDeep = 50;    // columns, whatever windows and levels reach
  const synthetic::DenseScene statue = MakeStatue();
  const fs::path masks = folder_.Path() / "masks";
  fs::create_directory(masks);
  const auto fill = [](int num_columns, Color color, ColorImage image) {
    for (int i = 0; i < image.width * image.height; ++i) {
      if (i % image.width < num_columns) {
        image.pixels[static_cast<size_t>(i)] = color;
        color[0] = static_cast<uint8_t>(color[0] * 77);  // noise, if not 0
      }
    }
    return image;
  };
  const auto write_masks = [&](int num_columns) {
    const ColorImage white{160, 120, std::vector<Color>(160 * 120, {9, 9, 9})};
    for (const View& view : statue.scene.views) {
      WriteFile(masks / (view.name + ".png"),
                EncodePng(fill(num_columns, {0, 0, 0}, white)));
    }
  };
  write_masks(kMasked);
  MakePlan(2, "--mask_path masks");  // jobs run elsewhere
  const std::string refined = RefineAndMerge(2);
  ExpectGoodMesh(refined_);
  const std::string option = PathOption("mask_path", masks);
  const fs::path untiled = RefineUntiled(option);
  EXPECT_LT(Error(refined_), 1.05 * Error(untiled));
  const std::string untiled_bytes = ReadFile(untiled);
  for (size_t i = 0; i < statue.images.size(); ++i) {
    WriteFile(path_ / "images" / statue.scene.views[i].name,
              EncodePng(fill(kDeep, {1, 200, 99}, statue.images[i])));
  }
  EXPECT_TRUE(ReadFile(RefineUntiled(option)) == untiled_bytes);
  EXPECT_TRUE(RefineAndMerge(2) == refined);
  write_masks(kDeep);
  fs::remove(PatchPath(0));
  ExpectRefusal(Run(Plan() + Tile(0)), "has changed since its refinement");
  EXPECT_TRUE(RefineAndMerge(2) != refined);
  fs::remove_all(masks);
  ExpectRefusal(PlanRefinement(), "no such folder of masks");
}

TEST_F(TiledRefinementTest, NothingIsLeftOutsideOfTheRegion) {
  constexpr float kSide = 0.3F;
  const std::string option = "--region=-9,-9,-9,0.3,9,9";
  MakePlan(2, option);
  RefineAndMerge(2);
  const auto farthest = [](const fs::path& path) {
    float x = -9;
    for (const Eigen::Vector3f& vertex : ReadPlyMesh(path).vertices) {
      x = std::max(x, vertex.x());
    }
    return x;
  };
  ExpectGoodMesh(refined_);
  EXPECT_NEAR(farthest(refined_), kSide, 1e-4);
  EXPECT_NEAR(farthest(RefineUntiled(option)), kSide, 1e-4);
}

TEST_F(TiledRefinementTest, KilledAndRepeatedJobsChangeNothing) {
  MakePlan(2);
  const std::string undisturbed = RefineAndMerge(2);
  EXPECT_TRUE(Has(PlanRefinement().out, "nothing to do"));
  EXPECT_TRUE(Has(Run(Plan() + Tile(0)).out, "nothing to do"));
  fs::remove(PatchPath(0));
  for (const char* seconds : {"0.02", "0.1", "0.4"}) {
    RunShell(std::string("timeout -s KILL ") + seconds + " " +
             CommandOf(Plan() + Tile(0)));
  }
  Succeed(Run(Plan() + Tile(0) + " @num_threads 1"));
  Succeed(MergeRefined());
  EXPECT_EQ(BytesOf(refined_), undisturbed);
}

TEST_F(TiledRefinementTest, GoesOnAfterTheLastCompleteLevel) {
  const auto [tile, undisturbed, files] = RefineTwoTiles();
  const int status = InterruptTile(tile, "full size, iteration 0", SIGTERM);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 143);
  EXPECT_TRUE(Has(ErrorOutput(), "1/2 size"));
  EXPECT_TRUE(
      WIFSIGNALED(InterruptTile(tile, "full size, iteration 1", SIGKILL)));
  EXPECT_FALSE(fs::exists(PatchPath(tile)));
  EXPECT_TRUE(Has(RefineAgain(tile), "continues after"));
  EXPECT_TRUE(ReadFile(PatchPath(tile)) == undisturbed);
  EXPECT_EQ(List(plan_), files);
}

TEST_F(TiledRefinementTest, GoesOnFromNothingElse) {
  const auto [tile, undisturbed, files] = RefineTwoTiles();
  const std::string state = PatchPath(tile).string() + ".resume";
  InterruptTile(tile, "full size, iteration 0", SIGKILL);
  const std::string of_this_run = ReadFile(state);
  WriteFile(state, of_this_run.substr(0, of_this_run.size() / 2));
  EXPECT_FALSE(Has(RefineAgain(tile), "continues after"));
  EXPECT_TRUE(ReadFile(PatchPath(tile)) == undisturbed);
  const int other = TilesOf(0).at(0);
  fs::remove(PatchPath(other));
  InterruptTile(other, "full size, iteration 0", SIGKILL);
  const std::string of_another =
      ReadFile(PatchPath(other).string() + ".resume");
  RefineAgain(other);
  fs::remove(PatchPath(tile));
  WriteFile(state, of_another);
  EXPECT_FALSE(Has(RefineAgain(tile), "continues after"));
  EXPECT_TRUE(ReadFile(PatchPath(tile)) == undisturbed);
}

TEST_F(TiledRefinementTest, JobsTakeNoMoreMemoryThanIsPlanned) {
  MakePlan(2);
  Succeed(PlanRefinement());
  const int tile = TilesOf(0).at(0);
  const nlohmann::json planned = PlannedTiles()[tile];
  const double memory_gb = planned["memory_gb"];
  const double thread_gb = planned["thread_gb"];
  for (const int num_threads : {1, 4}) {
    fs::remove(PatchPath(tile));
    const Outcome outcome = Succeed(Run(Plan() + Tile(tile) + " @num_threads " +
                                        std::to_string(num_threads)));
    const double peak_gb = NumberAfter("peak memory", outcome.out) / 1000;
    EXPECT_GT(peak_gb, 0.01);
    EXPECT_LT(peak_gb, memory_gb + num_threads * thread_gb);
  }
}

// Three statues in a row, of which the outer ones share a color.
TEST_F(TiledRefinementTest, TilesOfAColourDoNotDependOnEachOther) {
  fs::remove_all(path_);
  WriteWorkspace(synthetic::MakeSceneRow(MakeStatue(), 3, {20, 0, 0}), 1,
                 path_.string());
  MakePlan(3);
  const std::string undisturbed = RefineAndMerge(3);
  ASSERT_EQ(TilesOf(0).size(), 2);
  ASSERT_EQ(TilesOf(1).size(), 1);
  ExpectGoodMesh(refined_, 24);
  for (int tile = 0; tile < 3; ++tile) {
    fs::remove(PatchPath(tile));
  }
  const int first = TilesOf(0)[0];
  const int second = TilesOf(0)[1];
  EXPECT_TRUE(
      WIFSIGNALED(InterruptTile(first, "full size, iteration 0", SIGKILL)));
  ExpectRefusal(Run(Plan() + Tile(TilesOf(1)[0])), "of color 0 is not");
  const std::string command = CommandOf(Plan());
  Succeed(RunShell("{ " + command + Tile(second) + " & " + command +
                   Tile(first) + " && wait $!; }"));
  RefineAgain(TilesOf(1)[0]);
  Succeed(MergeRefined());
  EXPECT_TRUE(BytesOf(refined_) == undisturbed);
}

TEST_F(TiledRefinementTest, AFullDiskLosesNothing) {
  const auto [tile, undisturbed, files] = RefineTwoTiles();
  ExpectRefusal(
      RunShell("trap '' XFSZ; ulimit -f 16; " + CommandOf(Plan() + Tile(tile))),
      "cannot be written");
  RefineAgain(tile);
  EXPECT_TRUE(ReadFile(PatchPath(tile)) == undisturbed);
  EXPECT_EQ(List(plan_), files);
}

TEST_F(TiledRefinementTest, OnePlannerAtATime) {
  MakePlan(1);
  for (const std::string& planner :
       {CommandOf(Plan() + PathOption("input_path", merged_)),
        PlanCommand(2)}) {
    ExpectRefusal(
        RunShell("flock " + Quote(plan_ / "plan.lock") + " " + planner),
        "another planner is at work there");
  }
  EXPECT_FALSE(fs::exists(plan_ / "refine.json"));
  Succeed(PlanRefinement());
}

TEST_F(TiledRefinementTest, SaysWhatIsMissing) {
  MakePlan(2);
  ExpectRefusal(Run(Plan() + Tile(0)), "refine.json: not there");
  ExpectRefusal(Run(Plan()), "--plan_path needs --tile, or --input_path");
  ExpectRefusal(Run("--tile 1"), "--tile needs --plan_path");
  Succeed(PlanRefinement());
  ExpectRefusal(MergeRefined(), "is not refined");
  ExpectRefusal(Run(Plan() + Tile(7)), "has no tile 7");
  const std::vector<int> second = TilesOf(1);
  ASSERT_FALSE(second.empty());
  ExpectRefusal(Run(Plan() + Tile(second[0])), "of color 0 is not refined");
  EXPECT_FALSE(fs::exists(refined_));
}

TEST_F(TiledRefinementTest, RefusesTheMeshOfAnotherPlan) {
  MakePlan(1);
  std::string visibility = ReadFile(VisibilityPath(merged_));
  visibility.replace(12, 4, std::string("\x63\0\0\0", 4));
  WriteFile(VisibilityPath(merged_), visibility);
  ExpectRefusal(PlanRefinement(), "it belongs to another plan");
  EXPECT_FALSE(fs::exists(plan_ / "refine.json"));
  const TriangleMesh moved = Scaled(ReadPlyMesh(path_ / kInput), 3);
  Visibility none(moved.vertices.size());
  WriteMesh(merged_, moved, {{}, none, {}});
  ExpectRefusal(PlanRefinement(), "it belongs to another one");
}

}  // namespace colmap_ext::tiled_refinement_test
