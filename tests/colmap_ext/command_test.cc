// The commands as a user runs them: exit codes, messages, files.

#include <unistd.h>

#include "formats/encode_png.h"
#include "formats/read_ply.h"
#include "formats/read_visibility.h"
#include "tests/colmap_ext/page_of_run.h"
#include "tests/colmap_ext/run_shell.h"
#include "tests/formats/test_files.h"
#include "tests/workspace/sphere_workspace.h"

namespace colmap_ext {
namespace command_test {

namespace fs = std::filesystem;

constexpr const char* kMeshName = "meshed-delaunay-manifold.ply";

class CommandTest : public testing::TestWithParam<const char*> {
 protected:
  Outcome RunProgram(const std::string& arguments) {
    return RunShell(prefix_ + "\"" + GetParam() + "\" " + arguments);
  }

  Outcome Run(const std::string& arguments) {
    return RunProgram("delaunay_manifold_mesher " + arguments);
  }

  // One line that says what is wrong, exit code 1, and no mesh.
  void ExpectRefused(const std::string& arguments, const std::string& message) {
    ExpectRefusal(Run(arguments), message);
    EXPECT_FALSE(fs::exists(path_ / kMeshName)) << arguments;
  }

  std::string Workspace() const {
    return "--workspace_path \"" + path_.string() + "\"";
  }

  TemporaryFolder folder_;
  fs::path path_ = folder_.Path() / "a workspace";
  SphereWorkspace sphere_;
  std::string prefix_;  // of the command line
};

TEST_P(CommandTest, ListsItselfInTheHelp) {
  for (const char* arguments : {"", "help", "-h"}) {
    const Outcome outcome = RunProgram(arguments);
    EXPECT_EQ(outcome.exit_code, 0);
    for (const char* command :
         {"delaunay_manifold_mesher", "facetwise_refiner", "mesh_evaluator"}) {
      EXPECT_NE(outcome.out.find(command), std::string::npos) << command;
    }
  }
  EXPECT_EQ(RunProgram("no_such_command").exit_code, 1);
}

TEST_P(CommandTest, ExplainsItsOptions) {
  for (const char* arguments : {"-h", "--help"}) {
    const Outcome outcome = Run(arguments);
    EXPECT_EQ(outcome.exit_code, 0);
    for (const char* option :
         {"--workspace_path", "--input_path", "--output_path", "--input_type",
          "--project_path", "--image_order",
          "--DelaunayManifoldMeshing.max_proj_dist",
          "--DelaunayManifoldMeshing.half_pixel_correction",
          "--DelaunayManifoldMeshing.trim",
          "--DelaunayManifoldMeshing.close_holes",
          "--DelaunayManifoldMeshing.num_threads"}) {
      EXPECT_NE(outcome.out.find(option), std::string::npos) << option;
    }
  }
}

TEST_P(CommandTest, MeshesAWorkspace) {
  sphere_.Write(path_);
  const Outcome outcome = Run(Workspace());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.out << outcome.err;
  EXPECT_EQ(List(path_), "fused.ply fused.ply.vis images " +
                             std::string(kMeshName) + " " + kMeshName +
                             ".vis sparse");
  const PlyCloud mesh = ReadPlyCloud(path_ / kMeshName);
  EXPECT_GT(mesh.positions.size(), 100);
  EXPECT_EQ(mesh.colors.size(), mesh.positions.size());
  EXPECT_EQ(mesh.confidences.size(), mesh.positions.size());
  EXPECT_NO_THROW(ReadVisibility(path_ / (std::string(kMeshName) + ".vis"),
                                 mesh.positions.size()));
  for (const char* text :
       {"points read", "rays walked", "maximum flow", "minimum cut",
        "Singular vertices", "genus", "peak memory", "half pixel"}) {
    EXPECT_NE(outcome.out.find(text), std::string::npos) << text;
  }
}

TEST_P(CommandTest, WritesAPage) {
  sphere_.Write(path_);
  const fs::path page_path = path_ / "<page>.html";
  const std::string arguments =
      Workspace() + " --report_path \"" + page_path.string() + "\"";
  const Outcome outcome = Run(arguments);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::string page = ReadFile(page_path);
  ExpectPageOfRun(page, outcome);
  EXPECT_NE(page.find("&lt;page&gt;.html"), std::string::npos);
  for (const char* text : {"<h3>Points", "<h3>Mesh", "<h3>Confidence",
                           "<h3>Vertex colors", "rays walked"}) {
    EXPECT_NE(page.find(text), std::string::npos) << text;
  }
  EXPECT_GE(NumPictures(page), 12);
  WriteFile(page_path, "before");
  fs::remove(path_ / "fused.ply");
  EXPECT_EQ(Run(arguments).exit_code, 1);
  EXPECT_EQ(ReadFile(page_path), "before");
}

TEST_P(CommandTest, MeshesARegion) {
  sphere_.Write(path_);
  ASSERT_EQ(Run(Workspace() + " --region -2,-2,-2,2,2,0.3").exit_code, 0);
  for (const Eigen::Vector3f& position :
       ReadPlyCloud(path_ / kMeshName).positions) {
    EXPECT_LE(position.z(), 0.3f + 1e-5f);
  }
  const Outcome outcome = Run(Workspace() + " --region auto");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("region, center"), std::string::npos);
  const fs::path region = path_ / "meshed-delaunay-manifold.region.txt";
  const std::string found = ReadFile(path_ / kMeshName);
  ASSERT_EQ(
      Run(Workspace() + " --region \"" + region.string() + "\"").exit_code, 0);
  EXPECT_EQ(ReadFile(path_ / kMeshName), found);
  fs::remove(path_ / kMeshName);
  ExpectRefused(Workspace() + " --region nonsense", "--region");
  ExpectRefused(Workspace() + " --region 5,5,5,6,6,6", "region");
  ExpectRefused(Workspace() + " --region \"" + path_.string() + "\"",
                path_.string());
  WriteFile(region, "1 2 3");
  ExpectRefused(Workspace() + " --region \"" + region.string() + "\"",
                "not a region");
}

// Writes masks that leave out the upper part of every image.
void WriteMasks(const SphereWorkspace& sphere, double share,
                const fs::path& folder) {
  for (const SphereWorkspace::Image& image : sphere.images) {
    const View& view = image.view;
    ColorImage mask{view.width, view.height, {}};
    for (int i = 0; i < view.width * view.height; ++i) {
      const uint8_t value = i < share * view.width * view.height ? 0 : 255;
      mask.pixels.push_back({value, value, value});
    }
    const fs::path path = folder / (view.name + ".png");
    fs::create_directories(path.parent_path());
    WriteFile(path, EncodePng(mask));
  }
}

TEST_P(CommandTest, LeavesOutWhatIsMasked) {
  sphere_.Write(path_);
  const fs::path masks = folder_.Path() / "masks";
  const std::string arguments =
      Workspace() + " --mask_path \"" + masks.string() + "\"";
  WriteMasks(sphere_, 0.4, masks);
  const Outcome outcome = Run(arguments);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("points masked in all views"), std::string::npos);
  const Outcome carved = Run(arguments + " --mask_background 1");
  ASSERT_EQ(carved.exit_code, 0) << carved.err;
  EXPECT_NE(carved.out.find("rays beyond"), std::string::npos);
  fs::remove(path_ / kMeshName);
  ExpectRefused(Workspace() + " --mask_background 1", "--mask_path");
  WriteMasks(sphere_, 1, masks);
  ExpectRefused(arguments, "all points are masked");
  const fs::path mask = masks / (sphere_.images[0].view.name + ".png");
  WriteFile(mask, "no picture");
  ExpectRefused(arguments, mask.string());
  WriteFile(mask, EncodePng({2, 1, std::vector<Color>(2)}));
  ExpectRefused(arguments, mask.string());
  fs::remove_all(masks);
  ExpectRefused(arguments, "no such folder of masks");
}

TEST_P(CommandTest, TransformsWhatItWrites) {
  sphere_.Write(path_);
  ASSERT_EQ(Run(Workspace()).exit_code, 0);
  const PlyCloud before = ReadPlyCloud(path_ / kMeshName);
  const fs::path transform = folder_.Path() / "transform.txt";
  const std::string arguments =
      Workspace() + " --transform_path \"" + transform.string() + "\"";
  // A quarter turn around z, twice the size.
  const std::string matrix = "0 -2 0 100\n2 0 0 200\n0 0 2 300\n0 0 0 1\n";
  for (const std::string& text :
       {matrix, std::string("2 0.70710678118654752 0 0 0.70710678118654752 "
                            "100 200 300\n")}) {
    WriteFile(transform, text);
    ASSERT_EQ(Run(arguments).exit_code, 0);
    EXPECT_NE(ReadFile(path_ / kMeshName).find("property double x"),
              std::string::npos);
    const PlyCloud after = ReadPlyCloud(path_ / kMeshName);
    ASSERT_EQ(after.positions.size(), before.positions.size());
    for (size_t i = 0; i < after.positions.size(); ++i) {
      const Eigen::Vector3f& p = before.positions[i];
      EXPECT_LT(
          (after.positions[i] -
           Eigen::Vector3f(100 - 2 * p.y(), 200 + 2 * p.x(), 300 + 2 * p.z()))
              .norm(),
          1e-4);
    }
  }
  fs::remove(path_ / kMeshName);
  for (const char* text :
       {"", "1 2 3", "1 0 0 0 0 1 0 0 0 0 -1 0 0 0 0 1",
        "1 0 0 0 0 2 0 0 0 0 1 0 0 0 0 1", "0 1 0 0 0 0 0 0"}) {
    WriteFile(transform, text);
    ExpectRefused(arguments, "no similarity transform");
  }
}

TEST_P(CommandTest, IsADropInForDelaunayMesher) {
  sphere_.Write(path_);
  const fs::path mesh_path = folder_.Path() / "mesh.ply";
  const std::string paths = "--input_path \"" + path_.string() +
                            "\" --output_path \"" + mesh_path.string() + "\"";
  EXPECT_EQ(Run(paths).exit_code, 0);
  EXPECT_TRUE(fs::exists(mesh_path));
  EXPECT_FALSE(fs::exists(path_ / kMeshName));
  EXPECT_EQ(Run(paths + " --input_type sparse").exit_code, 0);
}

TEST_P(CommandTest, FindsTheWorkspaceOfAutomaticReconstructor) {
  sphere_.Write(path_ / "dense" / "0");
  const Outcome outcome = Run(Workspace());
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_TRUE(fs::exists(path_ / "dense" / "0" / kMeshName));
  EXPECT_NE(outcome.out.find("dense/0"), std::string::npos);
  sphere_.Write(path_ / "dense" / "1");
  ExpectRefused(Workspace(), "which workspace?");
}

TEST_P(CommandTest, TakesAProjectFile) {
  sphere_.Write(path_);
  const fs::path project = folder_.Path() / "project.ini";
  WriteFile(project, "workspace_path=" + path_.string() +
                         "\n[DelaunayManifoldMeshing]\nmax_proj_dist=5\n");
  EXPECT_EQ(Run("--project_path \"" + project.string() + "\"").exit_code, 0);
  EXPECT_TRUE(fs::exists(path_ / kMeshName));
  EXPECT_EQ(Run("--project_path /none").exit_code, 1);
}

TEST_P(CommandTest, GivesTheSameBytesOnAnyNumberOfThreads) {
  sphere_.Write(path_);
  std::string first;
  for (const char* num_threads : {"1", "2", "3", "-1"}) {
    ASSERT_EQ(Run(Workspace() + " --DelaunayManifoldMeshing.num_threads " +
                  num_threads)
                  .exit_code,
              0);
    const std::string bytes = ReadFile(path_ / kMeshName);
    EXPECT_EQ(bytes, first.empty() ? bytes : first);
    first = bytes;
  }
}

TEST_P(CommandTest, RefusesBadOptions) {
  sphere_.Write(path_);
  ExpectRefused("", "--workspace_path or --input_path");
  ExpectRefused(Workspace() + " --input_path .",
                "--workspace_path or --input_path");
  ExpectRefused("--input_path .", "--output_path is required");
  ExpectRefused(Workspace() + " --no_such_option 1", "no_such_option");
  ExpectRefused(Workspace() + " --DelaunayManifoldMeshing.num_threads abc",
                "abc");
  ExpectRefused(Workspace() + " --input_type fuzzy", "input_type");
  ExpectRefused(Workspace() + " --image_order random", "image_order");
  ExpectRefused(Workspace() + " --image_order frame", "image_order");
  ExpectRefused(Workspace() + " --report_path page.csv", "ends in .html");
  ExpectRefused(Workspace() + " --DelaunayManifoldMeshing.max_depth_dist 2",
                "max_depth_dist");
  ExpectRefused(Workspace() + " --DelaunayManifoldMeshing.max_proj_dist nan",
                "max_proj_dist");
  ExpectRefused(Workspace() + " --DelaunayManifoldMeshing.behind_sigma inf",
                "--DelaunayManifoldMeshing.behind_sigma is 'inf'; it has to be "
                "a number, 1e-06 ... 1000000");
}

TEST_P(CommandTest, RefusesMissingFiles) {
  ExpectRefused(Workspace(), "no such folder");
  fs::create_directory(path_);
  ExpectRefused(Workspace(), "stereo_fusion");
  for (const char* name : {"fused.ply", "fused.ply.vis", "sparse/images.bin",
                           "sparse/cameras.bin", "sparse/points3D.bin"}) {
    sphere_.Write(path_);
    fs::remove(path_ / name);
    ExpectRefused(Workspace(), path_.string());
  }
}

TEST_P(CommandTest, RefusesTruncatedFiles) {
  sphere_.frames = {{4, 9, 2, 7, 5, 1, 8}};
  for (const char* name :
       {"fused.ply", "fused.ply.vis", "sparse/images.bin", "sparse/cameras.bin",
        "sparse/points3D.bin", "sparse/frames.bin"}) {
    sphere_.Write(path_);
    const std::string bytes = ReadFile(path_ / name);
    for (const size_t size : {size_t{0}, size_t{4}, size_t{8}, size_t{20},
                              bytes.size() / 2, bytes.size() - 1}) {
      WriteFile(path_ / name, bytes.substr(0, size));
      ExpectRefused(Workspace(), fs::path(name).filename().string());
    }
  }
}

TEST_P(CommandTest, RefusesLoopsOfLinks) {
  for (const char* name : {"fused.ply", "fused.ply.vis", "sparse/images.bin"}) {
    fs::remove_all(path_);
    sphere_.Write(path_);
    fs::remove(path_ / name);
    fs::create_symlink(fs::path(name).filename(), path_ / name);
    ExpectRefused(Workspace(), std::string("ERROR: ") +
                                   (path_ / name).string() + ": Too many");
  }
}

TEST_P(CommandTest, SaysInOneLineWhatCanNotBePrinted) {
  ExpectRefused("'--no\n\033such' 1", "--no??such");
}

TEST_P(CommandTest, RefusesPlacesThatCanNotBeWrittenBeforeTheWork) {
  sphere_.Write(path_);
  const std::string input = "--input_path \"" + path_.string() + "\" ";
  for (const char* output : {"/proc/mesh.ply", "/dev/null/mesh.ply", "/tmp"}) {
    ExpectRefused(input + "--output_path " + output, "can not be written");
  }
  ExpectRefused(Workspace() + " --report_path /proc/page.html",
                "can not be written");
}

// A limit on the size of files stands for a full disk.
TEST_P(CommandTest, OnAFullDiskAllFilesStayAsTheyWere) {
  sphere_.Write(path_);
  const fs::path page = path_ / "page.html";
  const std::string arguments =
      Workspace() + " --report_path \"" + page.string() + "\"";
  ASSERT_EQ(Run(arguments).exit_code, 0);
  ASSERT_GT(fs::file_size(page), fs::file_size(path_ / kMeshName));
  for (const uintmax_t size :
       {fs::file_size(page) / 2, fs::file_size(path_ / kMeshName) - 1}) {
    WriteFile(path_ / kMeshName, "old");
    WriteFile(page, "old");
    const auto before = FilesOf(path_);
    prefix_ = "trap '' XFSZ; prlimit --fsize=" + std::to_string(size) + " ";
    ExpectRefusal(Run(arguments), "File too large");
    EXPECT_TRUE(FilesOf(path_) == before);
  }
}

TEST_P(CommandTest, RefusesToReplaceWhatItReads) {
  sphere_.Write(path_);
  const auto before = FilesOf(path_);
  for (const char* name :
       {"fused.ply", "sparse/cameras.bin", "fused.ply.vis"}) {
    ExpectRefused(
        Workspace() + " --output_path \"" + (path_ / name).string() + "\"",
        "would be replaced");
  }
  EXPECT_TRUE(FilesOf(path_) == before);
}

TEST_P(CommandTest, RefusesReadOnlyWorkspaces) {
  sphere_.Write(path_);
  constexpr fs::perms kReadOnly =
      fs::perms::owner_read | fs::perms::owner_exec | fs::perms::others_read |
      fs::perms::others_exec;
  fs::permissions(folder_.Path(), kReadOnly | fs::perms::owner_write);
  fs::permissions(path_, kReadOnly);
  if (geteuid() == 0) {  // who may write everywhere
    prefix_ = "setpriv --reuid=65534 --regid=65534 --clear-groups ";
    if (RunProgram("help").exit_code != 0) {
      GTEST_SKIP() << "root can not run the program as another user here";
    }
  }
  ExpectRefused(Workspace(), "can not be written");
  fs::permissions(path_, fs::perms::owner_all);
}

TEST_P(CommandTest, RefusesPointsWithoutVolume) {
  for (Eigen::Vector3f& point : sphere_.points) {
    point.z() = 0;
  }
  sphere_.write_normals = false;
  sphere_.Write(path_);
  ExpectRefused(Workspace() +
                    " --image_order file "
                    "--DelaunayManifoldMeshing.half_pixel_correction 0",
                "volume");
}

#ifdef COLMAP_EXT_PROGRAM
INSTANTIATE_TEST_SUITE_P(StandAlone, CommandTest,
                         testing::Values(COLMAP_EXT_PROGRAM));
#endif
#ifdef COLMAP_EXT_COLMAP_PROGRAM
INSTANTIATE_TEST_SUITE_P(PatchedColmap, CommandTest,
                         testing::Values(COLMAP_EXT_COLMAP_PROGRAM));
#endif
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(CommandTest);

}  // namespace command_test
}  // namespace colmap_ext
