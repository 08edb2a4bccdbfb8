#pragma once

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>

#include "formats/read_ply.h"
#include "formats/read_visibility.h"
#include "formats/write_mesh.h"
#include "mesh/topology.h"
#include "tests/colmap_ext/run_shell.h"
#include "tests/formats/test_files.h"
#include "tests/synthetic/write_workspace.h"

namespace colmap_ext {

inline constexpr const char* kInput = "meshed-delaunay-manifold.ply";
inline constexpr const char* kOutput = "meshed-refined.ply";
inline constexpr const char* kEarlierOutput = "of an earlier run";

#ifdef COLMAP_EXT_PROGRAM
inline const std::string kProgram = COLMAP_EXT_PROGRAM;
#else
inline const std::string kProgram;
#endif

inline std::string Quote(const std::string& text) { return "\"" + text + "\""; }

inline synthetic::DenseScene MakeStatue(int num_images) {
  synthetic::DenseSceneOptions options;
  options.scene.num_images = num_images;
  options.scene.width = 160;
  options.scene.height = 120;
  return MakeDenseScene(options);
}

// A workspace that delaunay_manifold_mesher has been run on.
struct MeshedWorkspace {
  MeshedWorkspace() {
    const synthetic::DenseScene scene = MakeStatue(8);
    truth = scene.scene.surface;
    WriteWorkspace(scene, 1, folder.Path().string());
    std::filesystem::remove_all(folder.Path() / "truth");
    RunShell(Quote(kProgram) + " delaunay_manifold_mesher --workspace_path " +
             Quote(folder.Path().string()));
  }

  TemporaryFolder folder;
  TriangleMesh truth;
};

// Runs facetwise_refiner in a workspace that is made anew for each test.
class RefinerFixture : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    if (!kProgram.empty()) {
      meshed_ = std::make_unique<MeshedWorkspace>();
    }
  }

  static void TearDownTestSuite() { meshed_.reset(); }

  void SetUp() override {
    if (kProgram.empty()) {
      GTEST_SKIP() << "there is no stand-alone program";
    }
    MakeWorkspace();
    ASSERT_TRUE(std::filesystem::exists(path_ / kInput));
  }

  void MakeWorkspace() const {
    std::filesystem::remove_all(path_);
    std::filesystem::copy(meshed_->folder.Path(), path_,
                          std::filesystem::copy_options::recursive);
  }

  Outcome Run(const std::string& arguments) const {
    const std::string backend = "--FacetwiseRefinement.backend ";
    return RunShell(Quote(kProgram) + " facetwise_refiner " + arguments +
                    (arguments.find(backend) == std::string::npos
                         ? " " + backend + "cpu"
                         : ""));
  }

  std::string Option(const std::string& option, const std::string& name) const {
    return " --" + option + " " + Quote((path_ / name).string());
  }

  std::string Workspace() const {
    return "--workspace_path " + Quote(path_.string());
  }

  void ExpectRefused(const std::string& arguments, const std::string& message) {
    ExpectRefusal(Run(arguments), message);
    EXPECT_FALSE(std::filesystem::exists(path_ / kOutput)) << arguments;
  }

  // The output is as promised.
  void ExpectGoodMesh(const std::filesystem::path& path,
                      uint32_t num_views = 8) const {
    const ColoredMesh refined = ReadColoredPlyMesh(path);
    EXPECT_TRUE(Analyze(refined.mesh).IsManifold())
        << Analyze(refined.mesh).Defects();
    EXPECT_EQ(refined.colors.size(), refined.mesh.vertices.size());
    EXPECT_EQ(refined.confidences.size(), refined.mesh.vertices.size());
    const Visibility visibility = ReadVisibility(
        VisibilityPath(path), refined.mesh.vertices.size(), kFusedCloud);
    EXPECT_GT(visibility.values.size(), refined.mesh.vertices.size());
    EXPECT_LT(
        *std::max_element(visibility.values.begin(), visibility.values.end()),
        num_views);
  }

  // The average score of what the images see of a mesh, scene units.
  double Error(const std::filesystem::path& path) const {
    const std::filesystem::path truth = folder_.Path() / "truth.ply";
    WriteColoredMesh(truth, meshed_->truth, {});
    const std::filesystem::path json = folder_.Path() / "figures.json";
    const Outcome outcome = RunShell(
        Quote(kProgram) + " mesh_evaluator --mesh_path " +
        Quote(path.string()) + " --truth_path " + Quote(truth.string()) +
        " --workspace_path " + Quote(path_.string()) + " --json_path " +
        Quote(json.string()) + " --MeshEvaluation.spacing 0.01");
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    const std::string key = "\"average_score\": ";
    const std::string figures = ReadFile(json);
    const size_t at = figures.find(key);
    return at == std::string::npos ? std::nan("")
                                   : std::stod(figures.substr(at + key.size()));
  }

  static inline std::unique_ptr<MeshedWorkspace> meshed_;
  TemporaryFolder folder_;
  std::filesystem::path path_ = folder_.Path() / "a workspace";
};

}  // namespace colmap_ext
