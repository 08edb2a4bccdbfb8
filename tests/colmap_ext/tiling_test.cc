// The commands of a plan as a user runs them.

#include <algorithm>
#include <filesystem>
#include <numeric>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "formats/read_ply.h"
#include "mesh/topology.h"
#include "scene/point_tree.h"
#include "tests/colmap_ext/run_shell.h"
#include "tests/mesh/known_meshes.h"
#include "tests/workspace/sphere_workspace.h"

namespace colmap_ext::tiling_test {

namespace fs = std::filesystem;

// Ascending.
std::vector<std::array<float, 3>> VerticesOf(const fs::path& path) {
  std::vector<std::array<float, 3>> vertices;
  for (const Eigen::Vector3f& p : ReadPlyMesh(path).vertices) {
    vertices.push_back({p.x(), p.y(), p.z()});
  }
  std::ranges::sort(vertices);
  return vertices;
}

struct TilingTest : testing::Test {
  TilingTest() { SphereWorkspace().Write(workspace_); }

  Outcome MakePlan(int num_tiles, const std::string& more = "") const {
    return RunProgram("mesh_planner" +
                      PathOption("workspace_path", workspace_) +
                      PathOption("output_path", plan_) + " --num_tiles " +
                      std::to_string(num_tiles) + " " + more);
  }

  std::string TileCommand(int tile) const {
    return "delaunay_manifold_mesher --tile " + std::to_string(tile) +
           PathOption("plan_path", plan_);
  }
  Outcome MakeTile(int tile) const { return RunProgram(TileCommand(tile)); }

  std::string MergeCommand() const {
    return CommandLine("mesh_merger" + PathOption("plan_path", plan_) +
                       PathOption("output_path", mesh_));
  }
  Outcome Merge(const std::string& more = "") const {
    return RunShell(MergeCommand() + more);
  }

  // \return the mesh's bytes
  std::string MakeMesh(const std::vector<int>& tiles) const {
    for (const int tile : tiles) {
      Succeed(MakeTile(tile));
    }
    Succeed(Merge());
    return BytesOf(mesh_);
  }

  // Plans, meshes all tiles, and merges.
  // \return the mesh's bytes
  std::string MakeAll(int num_tiles, const std::string& options = "") const {
    Succeed(MakePlan(num_tiles, options));
    std::vector<int> tiles(num_tiles);
    std::iota(tiles.begin(), tiles.end(), 0);
    return MakeMesh(tiles);
  }

  // The merged mesh is the one that the mesher makes.
  void ExpectMeshersFaces(const std::string& options = "") const {
    Succeed(RunProgram("delaunay_manifold_mesher" +
                       PathOption("workspace_path", workspace_) + options));
    EXPECT_EQ(
        TrianglesOf(ReadPlyMesh(mesh_)),
        TrianglesOf(ReadPlyMesh(workspace_ / "meshed-delaunay-manifold.ply")));
  }

  // Tiles make the mesh of one tile, where all points are kept: the same
  // vertices, and the same faces whose corners' x coordinates all count.
  template <typename Counts>
  void ExpectNoSeams(const std::string& options, const Counts& counts) const {
    const auto faces_that_count = [&] {
      auto faces = TrianglesOf(ReadPlyMesh(mesh_));
      std::erase_if(faces, [&](const auto& face) {
        return std::ranges::any_of(
            face, [&](const auto& corner) { return !counts(corner[0]); });
      });
      return faces;
    };
    const std::string keep_all =
        options + " @max_proj_dist 0 @drop_weaker_layers 0 @smoothing 0 ";
    MakeAll(1, keep_all);
    const auto whole = faces_that_count();
    const auto vertices = VerticesOf(mesh_);
    ASSERT_GT(whole.size(), 100u);
    const std::string plan_json = ReadFile(plan_ / "plan.json");
    const size_t at = plan_json.find("\"distance_sigma\": ") + 18;
    const std::string sigma =
        plan_json.substr(at, plan_json.find(',', at) - at);
    for (const int num_tiles : {2, 4}) {
      MakeAll(num_tiles, keep_all + "--distance_sigma " + sigma);
      EXPECT_TRUE(Analyze(ReadPlyMesh(mesh_)).IsManifold());
      EXPECT_EQ(faces_that_count(), whole) << num_tiles;
      EXPECT_EQ(VerticesOf(mesh_), vertices) << num_tiles;
    }
  }

  TemporaryFolder folder_;
  fs::path workspace_ = folder_.Path() / "a workspace";
  fs::path plan_ = folder_.Path() / "a plan";
  fs::path mesh_ = folder_.Path() / "merged.ply";
};

// Near their borders tiles measure the noise by fewer points.
TEST_F(TilingTest, TilesAreSmoothedAsOneIs) {
  const std::string keep_all = " @max_proj_dist 0";
  MakeAll(1, keep_all + " @smoothing 0");
  const TriangleMesh raw = ReadPlyMesh(mesh_);
  MakeAll(1, keep_all);
  const TriangleMesh whole = ReadPlyMesh(mesh_);
  MakeAll(4, keep_all);
  const TriangleMesh tiled = ReadPlyMesh(mesh_);
  const PointTree tree(whole.vertices);
  const auto mean_distance = [&](const TriangleMesh& mesh) {
    double sum = 0;
    for (const Eigen::Vector3f& vertex : mesh.vertices) {
      sum +=
          (whole.vertices[tree.Nearest(vertex, 1, 10).at(0)] - vertex).norm();
    }
    return sum / static_cast<double>(mesh.vertices.size());
  };
  EXPECT_GT(mean_distance(raw), 0);
  EXPECT_LT(mean_distance(tiled), 0.2 * mean_distance(raw));
}

TEST_F(TilingTest, OneTileLeavesOutWhatIsMasked) {
  const fs::path masks = folder_.Path() / "masks";
  for (const SphereWorkspace::Image& image : SphereWorkspace().images) {
    WriteMask(masks, image.view, 0.4);
  }
  const std::string option = PathOption("mask_path", masks);
  EXPECT_TRUE(Has(MakePlan(1, option).out, "points masked in all views"));
  EXPECT_TRUE(Has(MakePlan(1, option).out, "nothing to do"));
  const fs::path mask =
      masks / (SphereWorkspace().images[0].view.name + ".png");
  const std::string bytes = ReadFile(mask);
  fs::remove(mask);
  EXPECT_FALSE(Has(MakePlan(1, option).out, "nothing to do"));
  WriteFile(mask, bytes);
  MakeAll(1, option);
  ExpectMeshersFaces(option);
  const std::string background = option + " --mask_background 1";
  MakeAll(1, background);
  ExpectMeshersFaces(background);
  MakeAll(2, background);
  EXPECT_TRUE(Analyze(ReadPlyMesh(mesh_)).IsManifold());
  fs::remove_all(masks);
  ExpectRefusal(MakePlan(2, option), "no such folder of masks");
}

TEST_F(TilingTest, OneTileMakesTheMeshOfOneMachineAlsoTransformed) {
  const fs::path transform = folder_.Path() / "transform.txt";
  WriteFile(transform, "0 -2 0 100\n2 0 0 200\n0 0 2 300\n0 0 0 1\n");
  const std::string option = PathOption("transform_path", transform);
  MakeAll(1);
  ExpectMeshersFaces();
  Succeed(Merge(option));
  ExpectMeshersFaces(option);
  EXPECT_TRUE(Has(ReadFile(mesh_), "property double x"));
  WriteFile(transform, "1 2 3");
  ExpectRefusal(Merge(option), "no similarity transform");
}

TEST_F(TilingTest, TilesMakeAMeshWithoutSeamsAlsoOfARegion) {
  ExpectNoSeams("", [](float) { return true; });
  // At the border of a region the two halves of a facet that is cut may have
  // the other diagonal.
  ExpectNoSeams("--region=-0.8,-2,-2,0.7,2,1.5 ",
                [](float x) { return x > -0.799f && x < 0.699f; });
}

TEST_F(TilingTest, OneTileMeshesARegion) {
  for (const std::string option :
       {" --region=-0.8,-2,-2,0.7,2,1.5", " --region auto"}) {
    MakeAll(1, option);
    ExpectMeshersFaces(option);
  }
  EXPECT_TRUE(fs::exists(folder_.Path() / "merged.region.txt"));
}

TEST_F(TilingTest, OrderRepetitionAndKilledJobsChangeNothing) {
  const std::string forward = MakeAll(3);
  EXPECT_TRUE(Has(MakePlan(3).out, "nothing to do"));
  EXPECT_TRUE(Has(Succeed(MakeTile(1)).out, "nothing to do"));
  fs::remove_all(plan_);
  Succeed(MakePlan(3));
  for (const char* seconds : {"0.01", "0.03", "0.05", "0.08", "0.2"}) {
    RunShell(std::string("timeout -s KILL ") + seconds + " " +
             CommandLine(TileCommand(1)));
  }
  EXPECT_EQ(MakeMesh({2, 0, 1}), forward);
}

TEST_F(TilingTest, AMergerOnAFullDiskLeavesTheOldMesh) {
  const std::string undisturbed = MakeAll(3);
  const auto size = fs::file_size(mesh_);
  for (const uintmax_t num_bytes : {size / 20, size / 3, size - 1}) {
    ExpectFullDisk(MergeCommand(), num_bytes);
    EXPECT_EQ(BytesOf(mesh_), undisturbed);
    EXPECT_EQ(List(folder_.Path()),
              "a plan a workspace merged.ply merged.ply.vis");
  }
}

TEST_F(TilingTest, TheMergerReplacesNoFileOfThePlan) {
  MakeAll(1);
  for (const char* name : {"plan.json", "tile00000.cut.bin"}) {
    ExpectRefusal(RunProgram("mesh_merger" + PathOption("plan_path", plan_) +
                             PathOption("output_path", plan_ / name)),
                  "it is read, and would be replaced");
  }
  Succeed(Merge());
}

TEST_F(TilingTest, TheMergerFinishesTheSurfaceAsTheMesherDoes) {
  for (const std::string option :
       {"min_confidence 0.2", "close_holes -1", "min_component_faces 20"}) {
    SCOPED_TRACE(option);
    const std::string options = " @" + option;
    MakeAll(1, options);
    ExpectMeshersFaces(options);
  }
  MakeAll(2, " @remeshing 1");
  EXPECT_TRUE(Analyze(ReadPlyMesh(mesh_)).IsManifold());
}

TEST_F(TilingTest, RefusesWhatDoesNotFitTogether) {
  ExpectRefusal(MakeTile(0), "plan.json: not there: run mesh_planner");
  fs::create_directories(plan_ / "plan.json");
  ExpectRefusal(MakeTile(0), "plan.json: not a file: run mesh_planner");
  fs::remove_all(plan_);
  ExpectRefusal(MakePlan(100000), "too few points for 100000 tiles");
  EXPECT_FALSE(fs::exists(plan_));
  Succeed(MakePlan(2));
  ExpectRefusal(MakeTile(2), "has no tile 2, but those from 0 to 1");
  ExpectRefusal(RunProgram("delaunay_manifold_mesher --tile 0"),
                "belong together");
  ExpectRefusal(
      RunProgram(TileCommand(0) + PathOption("workspace_path", workspace_)),
      "omit --workspace_path");
  Succeed(MakeTile(0));
  ExpectRefusal(Merge(), "tile 1 is not done");
  EXPECT_FALSE(fs::exists(mesh_));
}

TEST_F(TilingTest, RefusesDamagedAndOtherPlans) {
  MakeAll(2);
  const fs::path cut = plan_ / "tile00001.cut.bin";
  const std::string bytes = ReadFile(cut);
  WriteFile(cut, bytes.substr(0, bytes.size() / 2));
  ExpectRefusal(Merge(), "truncated or damaged");
  // Another plan's: done again, not merged.
  Succeed(MakePlan(2, " @behind_sigma 2"));
  WriteFile(cut, bytes);
  ExpectRefusal(Merge(), "belongs to another plan");
  MakeMesh({0, 1});
  // Another tile's.
  const fs::path vertices = plan_ / "tile00001.vertices.bin";
  const std::string own = ReadFile(vertices);
  WriteFile(vertices, ReadFile(plan_ / "tile00000.vertices.bin"));
  ExpectRefusal(Merge(), "belongs to another plan, or has another name");
  WriteFile(vertices, own);
  const std::string json = ReadFile(plan_ / "plan.json");
  std::string other_version = json;
  const std::string version = "\"version\": ";
  other_version.insert(other_version.find(version) + version.size(), "7");
  WriteFile(plan_ / "plan.json", other_version);
  ExpectRefusal(MakeTile(0), "has the version 78");
  WriteFile(plan_ / "plan.json", json.substr(0, json.size() / 2));
  ExpectRefusal(MakeTile(0), "damaged");
}

// Flips a bit of a byte.
void Damage(const fs::path& path, size_t at) {
  std::string bytes = ReadFile(path);
  bytes[at] = static_cast<char>(bytes[at] ^ 4);
  WriteFile(path, bytes);
}

TEST_F(TilingTest, ADamagedByteIsToldWhereItIsRead) {
  const std::string undamaged = MakeAll(2);
  for (const char* name : {"tile00001.cut.bin", "tile00000.vertices.bin",
                           "blocks.bin", "plan.json"}) {
    const size_t size = fs::file_size(plan_ / name);
    int num_refused = 0;
    for (const double share : {0.0, 0.01, 0.3, 0.6, 0.9, 0.99, 0.99999}) {
      const auto at = static_cast<size_t>(share * static_cast<double>(size));
      Damage(plan_ / name, at);
      const Outcome outcome = Merge();
      if (outcome.exit_code != 0) {
        ExpectRefusal(outcome, name);
        ++num_refused;
      } else {
        EXPECT_EQ(BytesOf(mesh_), undamaged);
      }
      Damage(plan_ / name, at);
    }
    EXPECT_GE(num_refused, 3) << name;
  }
  EXPECT_EQ(MakeMesh({0, 1}), undamaged);
}

TEST_F(TilingTest, RefusesInputsThatChanged) {
  Succeed(MakePlan(2));
  std::string fused = ReadFile(workspace_ / "fused.ply");
  fused.back() = static_cast<char>(fused.back() + 1);
  WriteFile(workspace_ / "fused.ply", fused);
  ExpectRefusal(MakeTile(0), "has changed since it was planned");
}

}  // namespace colmap_ext::tiling_test
