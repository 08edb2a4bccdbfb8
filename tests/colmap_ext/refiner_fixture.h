#pragma once

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>

#include "formats/read_ply.h"
#include "formats/write_mesh.h"
#include "mesh/topology.h"
#include "tests/colmap_ext/run_shell.h"
#include "tests/synthetic/write_workspace.h"

namespace colmap_ext {

inline constexpr const char* kInput = "meshed-delaunay-manifold.ply";
inline constexpr const char* kOutput = "meshed-refined.ply";
inline constexpr const char* kEarlierOutput = "of an earlier run";

// \param pose_noise  px
inline synthetic::DenseScene MakeStatue(double pose_noise = 0) {
  synthetic::DenseSceneOptions options;
  options.pose_noise.pixels = pose_noise;
  options.scene.num_images = 8;
  options.scene.width = 160;
  options.scene.height = 120;
  return MakeDenseScene(options);
}

// A workspace that delaunay_manifold_mesher has been run on.
struct MeshedWorkspace {
  MeshedWorkspace() {
    const synthetic::DenseScene scene = MakeStatue();
    truth = scene.scene.surface;
    WriteWorkspace(scene, 1, folder.Path().string());
    std::filesystem::remove_all(folder.Path() / "truth");
    RunProgram("delaunay_manifold_mesher" +
               PathOption("workspace_path", folder.Path()));
  }

  TemporaryFolder folder;
  TriangleMesh truth;
};

// Runs facetwise_refiner in a workspace that is made anew for each test.
struct RefinerFixture : testing::Test {
  static void SetUpTestSuite() {
    meshed_ = std::make_unique<MeshedWorkspace>();
  }

  static void TearDownTestSuite() { meshed_.reset(); }

  void SetUp() override {
    std::filesystem::copy(meshed_->folder.Path(), path_,
                          std::filesystem::copy_options::recursive);
    ASSERT_TRUE(std::filesystem::exists(path_ / kInput));
  }

  // The command line of facetwise_refiner: by the processor, if not otherwise.
  static std::string CommandOf(const std::string& arguments) {
    return CommandLine("facetwise_refiner " + arguments +
                       (Has(arguments, "@backend") ? "" : " @backend cpu"));
  }

  static Outcome Run(const std::string& arguments) {
    return RunShell(CommandOf(arguments));
  }

  // In the workspace.
  Outcome Refine(const std::string& options = "") const {
    return Run(Workspace() + options);
  }

  // Runs facetwise_refiner, and sends it signals, one after the other, when it
  // has printed the text.
  // \return as waitpid() has it.
  int Interrupt(const std::string& arguments, const std::string& text,
                const std::vector<int>& signals) const {
    Process process(CommandOf(arguments), folder_.Path() / "err");
    EXPECT_TRUE(process.WaitFor(text)) << ErrorOutput();
    for (const int number : signals) {
      process.Signal(number);
    }
    return process.Wait();
  }

  std::string ErrorOutput() const { return ReadFile(folder_.Path() / "err"); }

  // \param name  in the workspace
  std::string Option(const std::string& option, const std::string& name) const {
    return PathOption(option, path_ / name);
  }

  std::string Workspace() const { return PathOption("workspace_path", path_); }

  void ExpectRefused(const std::string& options, const std::string& message) {
    ExpectRefusal(Refine(options), message);
    EXPECT_FALSE(std::filesystem::exists(path_ / kOutput)) << options;
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
    EXPECT_LT(std::ranges::max(visibility.values), num_views);
  }

  // The average score of what the images see of a mesh, scene units.
  double Error(const std::filesystem::path& path) const {
    const std::filesystem::path truth = folder_.Path() / "truth.ply";
    WriteColoredMesh(truth, meshed_->truth, {});
    const std::filesystem::path json = folder_.Path() / "figures.json";
    Succeed(RunProgram("mesh_evaluator @spacing 0.01" +
                       PathOption("mesh_path", path) +
                       PathOption("truth_path", truth) + Workspace() +
                       PathOption("json_path", json)));
    return NumberAfter("\"average_score\": ", ReadFile(json));
  }

  static inline std::unique_ptr<MeshedWorkspace> meshed_;
  TemporaryFolder folder_;
  std::filesystem::path path_ = folder_.Path() / "a workspace";
};

}  // namespace colmap_ext
