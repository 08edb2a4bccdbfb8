// What patches/ changes in COLMAP's own commands, by the patched program.

#include "tests/colmap_ext/run_shell.h"
#include "tests/formats/test_files.h"
#include "tests/workspace/sphere_workspace.h"

#ifdef COLMAP_EXT_COLMAP_PROGRAM

namespace colmap_ext {
namespace automatic_reconstructor_test {

namespace fs = std::filesystem;

constexpr const char* kMeshName = "meshed-delaunay-manifold.ply";

// A workspace whose sparse model and fused points are there already, so that
// only the meshing is left to do, which needs no CUDA.
class AutomaticReconstructorTest : public testing::Test {
 protected:
  AutomaticReconstructorTest() {
    sphere_.Write(dense_);
    fs::create_directories(path_ / "sparse");
    fs::copy(dense_ / "sparse", path_ / "sparse" / "0");
    fs::copy(dense_ / "images", path_ / "photos");
  }

  Outcome RunColmap(const std::string& arguments) {
    return RunShell("cd \"" + folder_.Path().string() + "\" && \"" +
                    COLMAP_EXT_COLMAP_PROGRAM + "\" " + arguments);
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
  Outcome outcome = Reconstruct("--mesher delaunay_manifold");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.out << outcome.err;
  EXPECT_TRUE(fs::exists(dense_ / kMeshName)) << outcome.out << outcome.err;
  EXPECT_FALSE(fs::exists(dense_ / "meshed-refined.ply"));
  const auto time = fs::last_write_time(dense_ / kMeshName);
  outcome = Reconstruct("--mesher DELAUNAY_MANIFOLD --refine_mesh 1");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.out << outcome.err;
  EXPECT_EQ(fs::last_write_time(dense_ / kMeshName), time);
  EXPECT_TRUE(fs::exists(dense_ / "meshed-refined.ply"))
      << outcome.out << outcome.err;
}

TEST_F(AutomaticReconstructorTest, LeavesOtherMeshersAsTheyAre) {
  EXPECT_EQ(Reconstruct("--mesher poisson").exit_code, 0);
  EXPECT_FALSE(fs::exists(dense_ / kMeshName));
  const Outcome help = RunColmap("automatic_reconstructor -h");
  EXPECT_NE((help.out + help.err).find("delaunay_manifold"), std::string::npos);
  EXPECT_NE((help.out + help.err).find("refine_mesh"), std::string::npos);
}

TEST_F(AutomaticReconstructorTest, FailsWhereTheMesherFails) {
  fs::remove(dense_ / "fused.ply.vis");
  const Outcome outcome = Reconstruct("--mesher delaunay_manifold");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.err.find("fused.ply.vis"), std::string::npos);
}

TEST_F(AutomaticReconstructorTest, UndistorterWritesOurCommands) {
  const Outcome outcome = RunColmap(
      "image_undistorter --image_path workspace/photos --input_path "
      "workspace/sparse/0 --output_path undistorted");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const fs::path folder = folder_.Path() / "undistorted";
  for (const char* name :
       {"run-colmap-geometric.sh", "run-colmap-photometric.sh"}) {
    EXPECT_NE(ReadFile(folder / name)
                  .find("\n$COLMAP_EXE_PATH/colmap delaunay_manifold_mesher "
                        "\\\n  --workspace_path .\n"
                        "$COLMAP_EXE_PATH/colmap facetwise_refiner"),
              std::string::npos)
        << ReadFile(folder / name);
  }
  // From delaunay_mesher on, in the workspace that has fused points. COLMAP's
  // own mesher may abort on so few, which does not end the script.
  fs::copy(folder / "run-colmap-geometric.sh", dense_);
  const std::string program = COLMAP_EXT_COLMAP_PROGRAM;
  const Outcome run = RunShell(
      "cd \"" + dense_.string() +
      "\" && sed -n '/delaunay_mesher/,$p' run-colmap-geometric.sh > rest.sh "
      "&& COLMAP_EXE_PATH=\"" +
      fs::path(program).parent_path().string() + "\" bash rest.sh");
  EXPECT_EQ(run.exit_code, 0) << run.out << run.err;
  for (const char* name : {kMeshName, "meshed-refined.ply"}) {
    EXPECT_TRUE(fs::exists(dense_ / name)) << name;
  }
}

}  // namespace automatic_reconstructor_test
}  // namespace colmap_ext

#endif
