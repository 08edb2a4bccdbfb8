// The refinement of a plan's tiles as a user runs it.

#include <sys/wait.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <string>
#include <vector>

#include "formats/encode_png.h"
#include "tests/colmap_ext/process.h"
#include "tests/colmap_ext/refiner_fixture.h"
#include "tests/synthetic/dense_scene.h"

namespace colmap_ext {
namespace tiled_refinement_test {

namespace fs = std::filesystem;

class TiledRefinementTest : public RefinerFixture {
 protected:
  Outcome RunCommand(const std::string& arguments) const {
    return RunShell(Quote(kProgram) + " " + arguments);
  }

  // Plans, meshes and merges.
  void MakePlan(int num_tiles, const std::string& more = "") const {
    fs::remove_all(plan_);
    const Outcome planned =
        RunShell("cd " + Quote(folder_.Path().string()) + " && " +
                 Quote(kProgram) + " mesh_planner " + Workspace() +
                 " --output_path " + Quote(plan_.string()) + " --num_tiles " +
                 std::to_string(num_tiles) + " " + more);
    EXPECT_EQ(planned.exit_code, 0) << planned.err;
    for (int tile = 0; tile < num_tiles; ++tile) {
      RunCommand("delaunay_manifold_mesher " + Plan() + Tile(tile));
    }
    const Outcome merged = RunCommand(
        "mesh_merger " + Plan() + " --output_path " + Quote(merged_.string()));
    EXPECT_EQ(merged.exit_code, 0) << merged.err;
  }

  Outcome PlanRefinement() const {
    return Run(Plan() + " --input_path " + Quote(merged_.string()) + kEffort);
  }

  void RefineTiles(int num_tiles) const {
    const Outcome planned = PlanRefinement();
    EXPECT_EQ(planned.exit_code, 0) << planned.err;
    for (int color = 0; color < num_tiles; ++color) {
      for (const int tile : TilesOf(color)) {
        const Outcome outcome = Run(Plan() + Tile(tile));
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
      }
    }
  }

  // By the plan.
  std::vector<int> TilesOf(int color) const {
    const std::string json = ReadFile(plan_ / "refine.json");
    const std::string key = "\"color\": ";
    std::vector<int> tiles;
    int tile = 0;
    for (size_t at = json.find(key); at != std::string::npos;
         at = json.find(key, at + 1), ++tile) {
      if (std::stoi(json.substr(at + key.size())) == color) {
        tiles.push_back(tile);
      }
    }
    return tiles;
  }

  Outcome MergeRefined() const {
    return RunCommand("mesh_merger " + Plan() + " --refined 1 --output_path " +
                      Quote(refined_.string()));
  }

  // Refines the merged mesh by its tiles.
  // \return its bytes
  std::string RefineAndMerge(int num_tiles) const {
    RefineTiles(num_tiles);
    const Outcome outcome = MergeRefined();
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return ReadFile(refined_) + ReadFile(VisibilityPath(refined_));
  }

  // The same without tiles, to a file of its own.
  fs::path RefineUntiled(const std::string& options) const {
    fs::path output = folder_.Path() / "untiled.ply";
    const Outcome outcome =
        Run(Workspace() + " --input_path " + Quote(merged_.string()) +
            " --output_path " + Quote(output.string()) + kEffort +
            " --FacetwiseRefinement.refine_cameras none " + options);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return output;
  }

  fs::path PatchPath(int tile) const {
    return plan_ / ("tile0000" + std::to_string(tile) + ".refined.bin");
  }

  // Sends a tile's job a signal when it has printed the text.
  // \return as waitpid() has it.
  int Interrupt(int tile, const std::string& text, int signal) const {
    Process process(
        kProgram,
        {"facetwise_refiner", "--FacetwiseRefinement.backend", "cpu", "--plan",
         plan_.string(), "--tile", std::to_string(tile)},
        folder_.Path() / "err");
    EXPECT_TRUE(process.WaitFor(text)) << ReadFile(folder_.Path() / "err");
    process.Signal(signal);
    return process.Wait();
  }

  // Refines a tile, its patch gone.
  // \return what the job prints
  std::string RefineAgain(int tile) const {
    const Outcome outcome = Run(Plan() + Tile(tile));
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return outcome.out;
  }

  std::string Plan() const { return "--plan " + Quote(plan_.string()); }
  static std::string Tile(int tile) {
    return " --tile " + std::to_string(tile);
  }

  static constexpr const char* kEffort =
      " --FacetwiseRefinement.levels 2 --FacetwiseRefinement.iterations 3";

  fs::path plan_ = folder_.Path() / "a plan";
  fs::path merged_ = folder_.Path() / "merged.ply";
  fs::path refined_ = folder_.Path() / "refined.ply";
};

TEST_F(TiledRefinementTest, MakesAMeshWithoutSeams) {
  MakePlan(1);
  RefineTiles(1);
  ASSERT_EQ(MergeRefined().exit_code, 0);
  ExpectGoodMesh(refined_);
  const double whole = Error(refined_);
  EXPECT_LT(whole, 0.9 * Error(merged_));
  for (const int num_tiles : {2, 4}) {
    MakePlan(num_tiles);
    RefineTiles(num_tiles);
    const Outcome outcome = MergeRefined();
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    ExpectGoodMesh(refined_);
    EXPECT_LT(Error(refined_), 1.05 * whole) << num_tiles;
  }
}

// The left part of each image is masked. Deep in it the images may be anything.
TEST_F(TiledRefinementTest, LeavesOutWhatIsMasked) {
  constexpr int kMasked = 70;  // columns
  constexpr int kDeep = 50;    // columns, whatever windows and levels reach
  const synthetic::DenseScene statue = MakeStatue(8);
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
  const ColorImage white{160, 120, std::vector<Color>(160 * 120, {9, 9, 9})};
  for (const View& view : statue.scene.views) {
    WriteFile(masks / (view.name + ".png"),
              EncodePng(fill(kMasked, {0, 0, 0}, white)));
  }
  MakePlan(2, "--mask_path masks");  // jobs run elsewhere
  const std::string refined = RefineAndMerge(2);
  ExpectGoodMesh(refined_);
  const std::string option = "--mask_path " + Quote(masks.string());
  const fs::path untiled = RefineUntiled(option);
  EXPECT_LT(Error(refined_), 1.05 * Error(untiled));
  const std::string untiled_bytes = ReadFile(untiled);
  for (size_t i = 0; i < statue.images.size(); ++i) {
    WriteFile(path_ / "images" / statue.scene.views[i].name,
              EncodePng(fill(kDeep, {1, 200, 99}, statue.images[i])));
  }
  EXPECT_TRUE(ReadFile(RefineUntiled(option)) == untiled_bytes);
  EXPECT_TRUE(RefineAndMerge(2) == refined);
  for (const View& view : statue.scene.views) {
    WriteFile(masks / (view.name + ".png"),
              EncodePng(fill(kDeep, {0, 0, 0}, white)));
  }
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
  RefineTiles(2);
  ASSERT_EQ(MergeRefined().exit_code, 0);
  const std::string undisturbed = ReadFile(refined_);
  EXPECT_NE(PlanRefinement().out.find("nothing to do"), std::string::npos);
  EXPECT_NE(Run(Plan() + Tile(0)).out.find("nothing to do"), std::string::npos);
  fs::remove(PatchPath(0));
  for (const char* seconds : {"0.02", "0.1", "0.4"}) {
    RunShell(std::string("timeout -s KILL ") + seconds + " " + Quote(kProgram) +
             " facetwise_refiner " + Plan() + Tile(0) +
             " --FacetwiseRefinement.backend cpu");
  }
  const Outcome again =
      Run(Plan() + Tile(0) + " --FacetwiseRefinement.num_threads 1");
  EXPECT_EQ(again.exit_code, 0) << again.err;
  ASSERT_EQ(MergeRefined().exit_code, 0);
  EXPECT_EQ(ReadFile(refined_), undisturbed);
}

TEST_F(TiledRefinementTest, GoesOnAfterTheLastCompleteLevel) {
  MakePlan(2);
  RefineTiles(2);
  const int tile = TilesOf(1).at(0);  // next to what is fixed
  const std::string undisturbed = ReadFile(PatchPath(tile));
  const std::string files = List(plan_);
  fs::remove(PatchPath(tile));
  const int status = Interrupt(tile, "full size, iteration 0", SIGTERM);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 143);
  EXPECT_NE(ReadFile(folder_.Path() / "err").find("1/2 size"),
            std::string::npos);
  EXPECT_TRUE(WIFSIGNALED(Interrupt(tile, "full size, iteration 1", SIGKILL)));
  EXPECT_FALSE(fs::exists(PatchPath(tile)));
  EXPECT_NE(RefineAgain(tile).find("goes on after"), std::string::npos);
  EXPECT_TRUE(ReadFile(PatchPath(tile)) == undisturbed);
  EXPECT_EQ(List(plan_), files);
}

TEST_F(TiledRefinementTest, GoesOnFromNothingElse) {
  MakePlan(2);
  RefineTiles(2);
  const int tile = TilesOf(1).at(0);
  const std::string undisturbed = ReadFile(PatchPath(tile));
  fs::path state = PatchPath(tile);
  state += ".resume";
  fs::remove(PatchPath(tile));
  Interrupt(tile, "full size, iteration 0", SIGKILL);
  const std::string of_this_run = ReadFile(state);
  WriteFile(state, of_this_run.substr(0, of_this_run.size() / 2));
  EXPECT_EQ(RefineAgain(tile).find("goes on after"), std::string::npos);
  EXPECT_TRUE(ReadFile(PatchPath(tile)) == undisturbed);
  const int other = TilesOf(0).at(0);
  fs::path other_state = PatchPath(other);
  other_state += ".resume";
  fs::remove(PatchPath(other));
  Interrupt(other, "full size, iteration 0", SIGKILL);
  const std::string of_another = ReadFile(other_state);
  RefineAgain(other);
  fs::remove(PatchPath(tile));
  WriteFile(state, of_another);
  EXPECT_EQ(RefineAgain(tile).find("goes on after"), std::string::npos);
  EXPECT_TRUE(ReadFile(PatchPath(tile)) == undisturbed);
}

// The numbers of a plan that stand behind a name.
std::vector<double> NumbersIn(const std::string& json,
                              const std::string& name) {
  const std::string key = "\"" + name + "\": ";
  std::vector<double> numbers;
  for (size_t at = json.find(key); at != std::string::npos;
       at = json.find(key, at + 1)) {
    numbers.push_back(std::stod(json.substr(at + key.size())));
  }
  return numbers;
}

TEST_F(TiledRefinementTest, JobsTakeNoMoreMemoryThanIsPlanned) {
  MakePlan(2);
  ASSERT_EQ(PlanRefinement().exit_code, 0);
  const std::string json = ReadFile(plan_ / "refine.json");
  const std::vector<double> memory = NumbersIn(json, "memory_gb");
  const std::vector<double> of_thread = NumbersIn(json, "thread_gb");
  ASSERT_EQ(memory.size(), 2);
  ASSERT_EQ(of_thread.size(), 2);
  const int tile = TilesOf(0).at(0);
  for (const int num_threads : {1, 4}) {
    fs::remove(PatchPath(tile));
    const Outcome outcome =
        Run(Plan() + Tile(tile) + " --FacetwiseRefinement.num_threads " +
            std::to_string(num_threads));
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const std::string line = "peak memory";
    const double peak_gb =
        std::stod(outcome.out.substr(outcome.out.find(line) + line.size())) /
        1000;
    EXPECT_GT(peak_gb, 0.01);
    EXPECT_LT(peak_gb, memory[tile] + num_threads * of_thread[tile]);
  }
}

// Three statues in a row, of which the outer ones share a colour.
TEST_F(TiledRefinementTest, TilesOfAColourDoNotDependOnEachOther) {
  fs::remove_all(path_);
  const synthetic::DenseScene statue = MakeStatue(8);
  WriteWorkspace(synthetic::MakeSceneRow(statue, 3, {20, 0, 0}), 1,
                 path_.string());
  MakePlan(3);
  RefineTiles(3);
  ASSERT_EQ(TilesOf(0).size(), 2);
  ASSERT_EQ(TilesOf(1).size(), 1);
  ASSERT_EQ(MergeRefined().exit_code, 0);
  ExpectGoodMesh(refined_, 24);
  const std::string undisturbed = ReadFile(refined_);
  for (int tile = 0; tile < 3; ++tile) {
    fs::remove(PatchPath(tile));
  }
  const int first = TilesOf(0)[0];
  const int second = TilesOf(0)[1];
  EXPECT_TRUE(WIFSIGNALED(Interrupt(first, "full size, iteration 0", SIGKILL)));
  ExpectRefusal(Run(Plan() + Tile(TilesOf(1)[0])), "of colour 0 is not");
  const std::string command = Quote(kProgram) + " facetwise_refiner " + Plan() +
                              " --FacetwiseRefinement.backend cpu";
  const Outcome both = RunShell("{ " + command + Tile(second) + " & " +
                                command + Tile(first) + " && wait $!; }");
  EXPECT_EQ(both.exit_code, 0) << both.err;
  RefineAgain(TilesOf(1)[0]);
  ASSERT_EQ(MergeRefined().exit_code, 0);
  EXPECT_TRUE(ReadFile(refined_) == undisturbed);
}

TEST_F(TiledRefinementTest, AFullDiskLosesNothing) {
  MakePlan(2);
  RefineTiles(2);
  const int tile = TilesOf(1).at(0);
  const std::string undisturbed = ReadFile(PatchPath(tile));
  const std::string files = List(plan_);
  fs::remove(PatchPath(tile));
  ExpectRefusal(RunShell("trap '' XFSZ; ulimit -f 16; " + Quote(kProgram) +
                         " facetwise_refiner " + Plan() + Tile(tile) +
                         " --FacetwiseRefinement.backend cpu"),
                "can not be written");
  RefineAgain(tile);
  EXPECT_TRUE(ReadFile(PatchPath(tile)) == undisturbed);
  EXPECT_EQ(List(plan_), files);
}

TEST_F(TiledRefinementTest, OnePlannerAtATime) {
  MakePlan(1);
  const std::string locked =
      "flock " + Quote((plan_ / "plan.lock").string()) + " " + Quote(kProgram);
  ExpectRefusal(RunShell(locked + " facetwise_refiner " + Plan() +
                         " --input_path " + Quote(merged_.string())),
                "another planner is at work there");
  ExpectRefusal(
      RunShell(locked + " mesh_planner " + Workspace() + " --output_path " +
               Quote(plan_.string()) + " --num_tiles 2"),
      "another planner is at work there");
  EXPECT_FALSE(fs::exists(plan_ / "refine.json"));
  EXPECT_EQ(PlanRefinement().exit_code, 0);
}

TEST_F(TiledRefinementTest, SaysWhatIsMissing) {
  MakePlan(2);
  ExpectRefusal(Run(Plan() + Tile(0)), "refine.json: not there");
  ExpectRefusal(Run(Plan()), "--plan_path needs --tile, or --input_path");
  ExpectRefusal(Run("--tile 1"), "--tile needs --plan_path");
  ExpectRefusal(
      Run(Plan() + Tile(0) + " --FacetwiseRefinement.refine_cameras poses"),
      "cameras are not refined in tiles");
  EXPECT_EQ(PlanRefinement().exit_code, 0);
  ExpectRefusal(MergeRefined(), "is not refined");
  ExpectRefusal(Run(Plan() + Tile(7)), "has no tile 7");
  const std::vector<int> second = TilesOf(1);
  ASSERT_FALSE(second.empty());
  ExpectRefusal(Run(Plan() + Tile(second[0])), "of colour 0 is not refined");
  EXPECT_FALSE(fs::exists(refined_));
}

TEST_F(TiledRefinementTest, RefusesTheMeshOfAnotherPlan) {
  MakePlan(1);
  std::string visibility = ReadFile(VisibilityPath(merged_));
  visibility.replace(12, 4, std::string("\x63\0\0\0", 4));
  WriteFile(VisibilityPath(merged_), visibility);
  ExpectRefusal(PlanRefinement(), "it belongs to another plan");
  EXPECT_FALSE(fs::exists(plan_ / "refine.json"));
  TriangleMesh moved = ReadPlyMesh(path_ / kInput);
  for (Eigen::Vector3f& vertex : moved.vertices) {
    vertex *= 0.999F;
  }
  Visibility none(moved.vertices.size());
  WriteMesh(merged_, moved, {{}, none, {}});
  ExpectRefusal(PlanRefinement(), "it belongs to another one");
}

}  // namespace tiled_refinement_test
}  // namespace colmap_ext
