// The commands as a user runs them: exit codes, messages, files.

#include <unistd.h>

#include "formats/picture_files.h"
#include "formats/read_ply.h"
#include "tests/colmap_ext/run_shell.h"
#include "tests/workspace/sphere_workspace.h"
#include "workspace/workspace_paths.h"

namespace colmap_ext::command_test {

namespace fs = std::filesystem;

struct CommandTest : testing::TestWithParam<std::string> {
  CommandTest() { sphere_.Write(path_); }

  Outcome RunProgram(const std::string& arguments) const {
    return RunShell(prefix_ + CommandLine(arguments, GetParam()));
  }

  Outcome Run(const std::string& arguments) const {
    return RunProgram("delaunay_manifold_mesher " + arguments);
  }

  // In the workspace.
  Outcome Mesh(const std::string& options = "") const {
    return Run(PathOption("workspace_path", path_) + options);
  }

  // One line that says what is wrong, exit code 1, and no mesh.
  void ExpectRefused(const std::string& options,
                     const std::string& message) const {
    ExpectRefusal(Mesh(options), message);
    EXPECT_FALSE(fs::exists(path_ / kMesherOutput)) << options;
  }

  SphereWorkspace sphere_;
  TemporaryFolder folder_;
  fs::path path_ = folder_.Path() / "a workspace";
  std::string prefix_;  // of the command line
};

// docs/option_tables compares the options.
TEST_P(CommandTest, ExplainsItselfAndItsOptions) {
  for (const char* arguments : {"", "help", "-h"}) {
    EXPECT_TRUE(HasAll(
        Succeed(RunProgram(arguments)).out,
        {"delaunay_manifold_mesher", "facetwise_refiner", "mesh_evaluator"}));
  }
  EXPECT_EQ(RunProgram("no_such_command").exit_code, 1);
  for (const char* arguments : {"-h", "--help"}) {
    EXPECT_TRUE(HasAll(Succeed(Run(arguments)).out,
                       {"--workspace_path", "--project_path",
                        "--DelaunayManifoldMeshing.min_confidence"}));
  }
}

TEST_P(CommandTest, MeshesAWorkspace) {
  const Outcome outcome = Succeed(Mesh());
  EXPECT_EQ(List(path_),
            "fused.ply fused.ply.vis images meshed-delaunay-manifold.ply "
            "meshed-delaunay-manifold.ply.vis sparse");
  const PlyCloud mesh = ReadPlyCloud(path_ / kMesherOutput);
  EXPECT_GT(mesh.positions.size(), 100);
  EXPECT_EQ(mesh.colors.size(), mesh.positions.size());
  EXPECT_EQ(mesh.confidences.size(), mesh.positions.size());
  EXPECT_NO_THROW(ReadVisibility(path_ / ("meshed-delaunay-manifold.ply.vis"),
                                 mesh.positions.size()));
  EXPECT_TRUE(HasAll(outcome.out, {"points read", "rays walked", "maximum flow",
                                   "minimum cut", "Singular vertices", "genus",
                                   "peak memory", "half pixel"}));
}

TEST_P(CommandTest, WritesAPage) {
  const fs::path page_path = path_ / "<page>.html";
  const std::string arguments = PathOption("report_path", page_path);
  const Outcome outcome = Succeed(Mesh(arguments));
  const std::string page = ReadFile(page_path);
  ExpectPageOfRun(page, outcome);
  EXPECT_TRUE(
      HasAll(page, {"&lt;page&gt;.html", "<h3>Points", "<h3>Mesh",
                    "<h3>Confidence", "<h3>Vertex colors", "rays walked"}));
  EXPECT_GE(Count(page, "<img "), 12);
  WriteFile(page_path, "before");
  fs::remove(path_ / "fused.ply");
  EXPECT_EQ(Mesh(arguments).exit_code, 1);
  EXPECT_EQ(ReadFile(page_path), "before");
}

TEST_P(CommandTest, MeshesARegion) {
  Succeed(Mesh(" --region -2,-2,-2,2,2,0.3"));
  for (const Eigen::Vector3f& position :
       ReadPlyCloud(path_ / kMesherOutput).positions) {
    EXPECT_LE(position.z(), 0.3f + 1e-5f);
  }
  EXPECT_TRUE(Has(Succeed(Mesh(" --region auto")).out, "region, center"));
  const fs::path region = path_ / "meshed-delaunay-manifold.region.txt";
  const std::string found = ReadFile(path_ / kMesherOutput);
  Succeed(Mesh(PathOption("region", region)));
  EXPECT_EQ(ReadFile(path_ / kMesherOutput), found);
  fs::remove(path_ / kMesherOutput);
  ExpectRefused(" --region nonsense", "--region");
  ExpectRefused(" --region 5,5,5,6,6,6", "region");
  ExpectRefused(PathOption("region", path_), path_.string());
  WriteFile(region, "1 2 3");
  ExpectRefused(PathOption("region", region), "not a region");
}

TEST_P(CommandTest, LeavesOutWhatIsMasked) {
  const fs::path masks = folder_.Path() / "masks";
  const std::string arguments = PathOption("mask_path", masks);
  const auto write_masks = [&](double share) {
    for (const SphereWorkspace::Image& image : sphere_.images) {
      WriteMask(masks, image.view, share);
    }
  };
  write_masks(0.4);
  EXPECT_TRUE(Has(Succeed(Mesh(arguments)).out, "points masked in all views"));
  EXPECT_TRUE(Has(Succeed(Mesh(arguments + " --mask_background 1")).out,
                  "rays beyond"));
  fs::remove(path_ / kMesherOutput);
  ExpectRefused(" --mask_background 1", "--mask_path");
  write_masks(1);
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
  Succeed(Mesh());
  const PlyCloud before = ReadPlyCloud(path_ / kMesherOutput);
  const fs::path transform = folder_.Path() / "transform.txt";
  const std::string arguments = PathOption("transform_path", transform);
  // A quarter turn around z, twice the size.
  const std::string matrix = "0 -2 0 100\n2 0 0 200\n0 0 2 300\n0 0 0 1\n";
  for (const std::string& text :
       {matrix,
        std::string(
            "2 0.70710678118654752 0 0 0.70710678118654752 100 200 300\n")}) {
    WriteFile(transform, text);
    Succeed(Mesh(arguments));
    EXPECT_TRUE(Has(ReadFile(path_ / kMesherOutput), "property double x"));
    const PlyCloud after = ReadPlyCloud(path_ / kMesherOutput);
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
  fs::remove(path_ / kMesherOutput);
  for (const char* text :
       {"", "1 2 3", "1 0 0 0 0 1 0 0 0 0 -1 0 0 0 0 1",
        "1 0 0 0 0 2 0 0 0 0 1 0 0 0 0 1", "0 1 0 0 0 0 0 0"}) {
    WriteFile(transform, text);
    ExpectRefused(arguments, "no similarity transform");
  }
}

TEST_P(CommandTest, FindsTheWorkspaceOfAutomaticReconstructor) {
  fs::remove_all(path_);
  sphere_.Write(path_ / "dense" / "0");
  const Outcome outcome = Succeed(Mesh());
  EXPECT_TRUE(fs::exists(path_ / "dense" / "0" / kMesherOutput));
  EXPECT_TRUE(Has(outcome.out, "dense/0"));
  sphere_.Write(path_ / "dense" / "1");
  ExpectRefused("", "which workspace?");
}

TEST_P(CommandTest, GivesTheSameBytesOnAnyNumberOfThreads) {
  std::string first;
  for (const char* num_threads : {"1", "2", "3", "-1"}) {
    Succeed(Mesh(std::string(" @num_threads ") + num_threads));
    const std::string bytes = ReadFile(path_ / kMesherOutput);
    EXPECT_EQ(bytes, first.empty() ? bytes : first);
    first = bytes;
  }
}

TEST_P(CommandTest, RefusesBadOptions) {
  ExpectRefusal(Run(""), "--workspace_path or --input_path");
  ExpectRefused(" --input_path .", "--workspace_path or --input_path");
  ExpectRefusal(Run("--input_path ."), "--output_path is required");
  ExpectRefused(" --image_order frame", "image_order");
  ExpectRefused(" --report_path page.csv", "ends in .html");
  ExpectRefused(" @behind_sigma inf",
                "--DelaunayManifoldMeshing.behind_sigma is 'inf'; it has to be "
                "a number, 1e-06 ... 1000000");
  ExpectRefused(" '--no\n\033such' 1", "--no??such");
}

TEST_P(CommandTest, RefusesMissingFilesAndLoopsOfLinks) {
  fs::remove_all(path_);
  ExpectRefused("", "no such folder");
  fs::create_directory(path_);
  ExpectRefused("", "stereo_fusion");
  for (const char* name : {"fused.ply", "fused.ply.vis", "sparse/images.bin",
                           "sparse/cameras.bin", "sparse/points3D.bin"}) {
    fs::remove_all(path_);
    sphere_.Write(path_);
    const fs::path file = path_ / name;
    fs::remove(file);
    ExpectRefused("", path_.string());
    fs::create_symlink(file.filename(), file);
    ExpectRefused("", "ERROR: " + file.string() + ": Too many");
  }
}

TEST_P(CommandTest, RefusesPlacesThatCanNotBeWrittenBeforeTheWork) {
  for (const char* output : {"/proc/mesh.ply", "/dev/null/mesh.ply", "/tmp"}) {
    ExpectRefused(PathOption("output_path", output), "cannot be written");
  }
  ExpectRefused(" --report_path /proc/page.html", "cannot be written");
}

// A limit on the size of files stands for a full disk.
TEST_P(CommandTest, OnAFullDiskAllFilesStayAsTheyWere) {
  const fs::path page = path_ / "page.html";
  const std::string arguments = PathOption("report_path", page);
  Succeed(Mesh(arguments));
  ASSERT_GT(fs::file_size(page), fs::file_size(path_ / kMesherOutput));
  for (const uintmax_t size :
       {fs::file_size(page) / 2, fs::file_size(path_ / kMesherOutput) - 1}) {
    WriteFile(path_ / kMesherOutput, "old");
    WriteFile(page, "old");
    const auto before = FilesOf(path_);
    prefix_ = "trap '' XFSZ; prlimit --fsize=" + std::to_string(size) + " ";
    ExpectRefusal(Mesh(arguments), "File too large");
    EXPECT_TRUE(FilesOf(path_) == before);
  }
}

TEST_P(CommandTest, RefusesToReplaceWhatItReads) {
  const auto before = FilesOf(path_);
  for (const char* name :
       {"fused.ply", "sparse/cameras.bin", "fused.ply.vis"}) {
    ExpectRefused(PathOption("output_path", path_ / name), "would be replaced");
  }
  EXPECT_TRUE(FilesOf(path_) == before);
}

TEST_P(CommandTest, RefusesReadOnlyWorkspaces) {
  constexpr fs::perms kReadOnly =
      fs::perms::owner_read | fs::perms::owner_exec | fs::perms::others_read |
      fs::perms::others_exec;
  fs::permissions(folder_.Path(), kReadOnly | fs::perms::owner_write);
  fs::permissions(path_, kReadOnly);
  if (geteuid() == 0) {  // who may write everywhere
    prefix_ = "setpriv --reuid=65534 --regid=65534 --clear-groups ";
    if (RunProgram("help").exit_code != 0) {
      GTEST_SKIP() << "root cannot run the program as another user here";
    }
  }
  ExpectRefused("", "cannot be written");
  fs::permissions(path_, fs::perms::owner_all);
}

INSTANTIATE_TEST_SUITE_P(Programs, CommandTest, testing::ValuesIn(Programs()));

}  // namespace colmap_ext::command_test
