// COLMAP's own program: what patches/ changes in its commands, and what ours
// have in common with them.

#include "formats/read_ply.h"
#include "tests/colmap_ext/run_shell.h"
#include "tests/synthetic/write_workspace.h"
#include "tests/workspace/sphere_workspace.h"
#include "workspace/workspace_paths.h"

#ifdef COLMAP_EXT_COLMAP_PROGRAM

namespace colmap_ext::colmap_program_test {

namespace fs = std::filesystem;

// A workspace whose sparse model and fused points are there already, so that
// only the meshing is left to do, which needs no CUDA.
struct AutomaticReconstructorTest : testing::Test {
  AutomaticReconstructorTest() {
    sphere_.Write(dense_);
    fs::create_directories(path_ / "sparse");
    fs::copy(dense_ / "sparse", path_ / "sparse" / "0");
    fs::copy(dense_ / "images", path_ / "photos");
  }

  Outcome RunColmap(const std::string& arguments) {
    return RunShell("cd " + Quote(folder_.Path()) + " && " +
                    CommandLine(arguments, COLMAP_EXT_COLMAP_PROGRAM));
  }

  Outcome Reconstruct(const std::string& options) {
    return RunColmap(
        "automatic_reconstructor --workspace_path workspace --image_path "
        "workspace/photos --quality low --use_gpu 0 --dense 1 " +
        options);
  }

  TemporaryFolder folder_;
  fs::path path_ = folder_.Path() / "workspace";
  fs::path dense_ = path_ / "dense" / "0";
  SphereWorkspace sphere_;
};

TEST_F(AutomaticReconstructorTest, MeshesAndRefinesWhatIsNotDoneYet) {
  Succeed(Reconstruct("--mesher delaunay_manifold"));
  EXPECT_TRUE(fs::exists(dense_ / kMesherOutput));
  EXPECT_FALSE(fs::exists(dense_ / "meshed-refined.ply"));
  const auto time = fs::last_write_time(dense_ / kMesherOutput);
  Succeed(Reconstruct("--mesher DELAUNAY_MANIFOLD --refine_mesh 1"));
  EXPECT_EQ(fs::last_write_time(dense_ / kMesherOutput), time);
  EXPECT_TRUE(fs::exists(dense_ / "meshed-refined.ply"));
}

TEST_F(AutomaticReconstructorTest, LeavesOtherMeshersAsTheyAre) {
  Succeed(Reconstruct("--mesher poisson"));
  EXPECT_FALSE(fs::exists(dense_ / kMesherOutput));
  const Outcome help = RunColmap("automatic_reconstructor -h");
  EXPECT_TRUE(Has((help.out + help.err), "delaunay_manifold"));
  EXPECT_TRUE(Has((help.out + help.err), "refine_mesh"));
}

TEST_F(AutomaticReconstructorTest, FailsWhereTheMesherFails) {
  fs::remove(dense_ / "fused.ply.vis");
  const Outcome outcome = Reconstruct("--mesher delaunay_manifold");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_TRUE(Has(outcome.err, "fused.ply.vis"));
}

TEST_F(AutomaticReconstructorTest, UndistorterWritesOurCommands) {
  Succeed(
      RunColmap("image_undistorter --image_path workspace/photos --input_path "
                "workspace/sparse/0 --output_path undistorted"));
  const fs::path folder = folder_.Path() / "undistorted";
  for (const char* name :
       {"run-colmap-geometric.sh", "run-colmap-photometric.sh"}) {
    EXPECT_TRUE(Has(ReadFile(folder / name),
                    "\n$COLMAP_EXE_PATH/colmap delaunay_manifold_mesher "
                    "\\\n  --workspace_path .\n"
                    "$COLMAP_EXE_PATH/colmap facetwise_refiner"))
        << ReadFile(folder / name);
  }
  // From delaunay_mesher on, in the workspace that has fused points. COLMAP's
  // own mesher may abort on so few, which does not end the script.
  fs::copy(folder / "run-colmap-geometric.sh", dense_);
  const std::string program = COLMAP_EXT_COLMAP_PROGRAM;
  const Outcome run = Succeed(RunShell(
      "cd \"" + dense_.string() +
      "\" && sed -n '/delaunay_mesher/,$p' run-colmap-geometric.sh > rest.sh "
      "&& COLMAP_EXE_PATH=\"" +
      fs::path(program).parent_path().string() + "\" bash rest.sh"));
  for (const char* name : {kMesherOutput, "meshed-refined.ply"}) {
    EXPECT_TRUE(fs::exists(dense_ / name)) << name;
  }
}

// Our thinning keeps about as many points as COLMAP's own delaunay_mesher does
// with the same option.
void ExpectSimilarThinning(const fs::path& workspace, double max_proj_dist,
                           double max_share) {
  const TemporaryFolder folder;
  const std::string output =
      PathOption("output_path", folder.Path() / "mesh.ply");
  const std::string distance = "max_proj_dist " + std::to_string(max_proj_dist);
  const auto number_after = [](const std::string& text,
                               const std::string& arguments) {
    return NumberAfter(
        text,
        Succeed(RunShell(CommandLine(arguments, COLMAP_EXT_COLMAP_PROGRAM)))
            .out);
  };
  const double theirs =
      number_after("Triangulation has",
                   "delaunay_mesher --input_type dense --DelaunayMeshing." +
                       distance + PathOption("input_path", workspace) + output);
  const double ours = number_after(
      "vertices, after thinning",
      "delaunay_manifold_mesher @half_pixel_correction off @" + distance +
          PathOption("workspace_path", workspace) + output);
  const auto num_points = static_cast<double>(
      ReadPlyCloud(workspace / "fused.ply").positions.size());
  EXPECT_LT(theirs, max_share * num_points);
  EXPECT_GT(ours, 0.6 * theirs);
  EXPECT_LT(ours, 1.3 * theirs);
}

TEST(Thinning, KeepsAboutAsManyPointsAsColmapOnPhotographs) {
  const fs::path workspace = fs::path(COLMAP_EXT_DATA) / "toycars";
  if (!fs::exists(workspace / "fused.ply")) {
    GTEST_SKIP() << "there is no " << workspace;
  }
  ExpectSimilarThinning(workspace, 20, 0.5);
  ExpectSimilarThinning(workspace, 8, 0.9);
}

TEST(Thinning, KeepsAboutAsManyPointsAsColmapOnAStatue) {
  synthetic::DenseSceneOptions options;
  options.scene.num_images = 8;
  options.scene.width = 320;
  options.scene.height = 240;
  const TemporaryFolder folder;
  WriteWorkspace(MakeDenseScene(options), 1, folder.Path().string());
  ExpectSimilarThinning(folder.Path(), 20, 0.5);
}

}  // namespace colmap_ext::colmap_program_test

#endif
