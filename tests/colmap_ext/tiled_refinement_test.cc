// The refinement of a plan's tiles as a user runs it.

#include <filesystem>
#include <string>
#include <vector>

#include "tests/colmap_ext/refiner_fixture.h"

namespace colmap_ext {
namespace {

namespace fs = std::filesystem;

class TiledRefinementTest : public RefinerFixture {
 protected:
  Outcome RunCommand(const std::string& arguments) const {
    return RunShell(Quote(kProgram) + " " + arguments);
  }

  // Plans, meshes and merges.
  void MakePlan(int num_tiles) const {
    fs::remove_all(plan_);
    const Outcome planned = RunCommand(
        "mesh_planner " + Workspace() + " --output_path " +
        Quote(plan_.string()) + " --num_tiles " + std::to_string(num_tiles));
    EXPECT_EQ(planned.exit_code, 0) << planned.err;
    for (int tile = 0; tile < num_tiles; ++tile) {
      RunCommand("delaunay_manifold_mesher " + Plan() + Tile(tile));
    }
    const Outcome merged = RunCommand(
        "mesh_merger " + Plan() + " --output_path " + Quote(merged_.string()));
    EXPECT_EQ(merged.exit_code, 0) << merged.err;
  }

  Outcome PlanRefinement() const {
    return Run(Plan() + " --input_path " + Quote(merged_.string()) +
               " --FacetwiseRefinement.levels 2"
               " --FacetwiseRefinement.iterations 3");
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

  std::string Plan() const { return "--plan " + Quote(plan_.string()); }
  static std::string Tile(int tile) {
    return " --tile " + std::to_string(tile);
  }

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

TEST_F(TiledRefinementTest, KilledAndRepeatedJobsChangeNothing) {
  MakePlan(2);
  RefineTiles(2);
  ASSERT_EQ(MergeRefined().exit_code, 0);
  const std::string undisturbed = ReadFile(refined_);
  EXPECT_NE(PlanRefinement().out.find("nothing to do"), std::string::npos);
  EXPECT_NE(Run(Plan() + Tile(0)).out.find("nothing to do"), std::string::npos);
  fs::remove(plan_ / "tile00000.refined.bin");
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

TEST_F(TiledRefinementTest, SaysWhatIsMissing) {
  MakePlan(2);
  ExpectRefusal(Run(Plan() + Tile(0)), "refine.json: not there");
  ExpectRefusal(Run(Plan()), "--plan needs --tile, or --input_path");
  ExpectRefusal(Run("--tile 1"), "--tile needs --plan");
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

}  // namespace
}  // namespace colmap_ext
