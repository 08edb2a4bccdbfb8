// mesh_evaluator as a user runs it: exit codes, messages, files.

#include <cmath>
#include <numbers>

#include <nlohmann/json.hpp>

#include "formats/picture_size.h"
#include "formats/read_ply.h"
#include "formats/write_mesh.h"
#include "tests/colmap_ext/run_shell.h"
#include "tests/formats/test_files.h"
#include "tests/workspace/sphere_workspace.h"

namespace colmap_ext {
namespace mesh_evaluator_test {

namespace fs = std::filesystem;

// A sphere around the origin.
TriangleMesh Sphere(float radius) {
  constexpr uint32_t kNumRings = 40;
  constexpr uint32_t kNumSides = 60;
  TriangleMesh mesh;
  for (uint32_t ring = 0; ring <= kNumRings; ++ring) {
    for (uint32_t side = 0; side < kNumSides; ++side) {
      const double polar = std::numbers::pi * (ring + 0.01) / kNumRings / 1.001;
      const double azimuth = 2 * std::numbers::pi * side / kNumSides;
      mesh.vertices.emplace_back(
          radius * Eigen::Vector3d(std::sin(polar) * std::cos(azimuth),
                                   std::sin(polar) * std::sin(azimuth),
                                   std::cos(polar))
                       .cast<float>());
      const uint32_t next = (side + 1) % kNumSides;
      if (ring < kNumRings) {
        const uint32_t a = ring * kNumSides + side;
        const uint32_t b = ring * kNumSides + next;
        mesh.facets.push_back({a, a + kNumSides, b});
        mesh.facets.push_back({b, a + kNumSides, b + kNumSides});
      }
    }
  }
  return mesh;
}

class MeshEvaluatorTest : public testing::Test {
 protected:
  void SetUp() override {
#ifndef COLMAP_EXT_PROGRAM
    GTEST_SKIP() << "there is no stand-alone program";
#else
    program_ = COLMAP_EXT_PROGRAM;
#endif
    WriteColoredMesh(Path("mesh.ply"), Sphere(1.01f), {});
    WriteColoredMesh(Path("truth.ply"), Sphere(1), {});
    sphere_.Write(Path("workspace"));
  }

  fs::path Path(const std::string& name) const { return folder_.Path() / name; }

  std::string Option(const std::string& option, const std::string& name) const {
    return " --" + option + " \"" + Path(name).string() + "\"";
  }

  Outcome Run(const std::string& arguments) const {
    return RunShell("\"" + program_ + "\" mesh_evaluator " + arguments);
  }

  // Mesh, truth, a spacing for quick tests.
  std::string Basics() const {
    return Option("mesh_path", "mesh.ply") + Option("truth_path", "truth.ply") +
           " --MeshEvaluation.spacing 0.05";
  }

  // The number behind `"name": ` in a JSON text.
  static double Number(const std::string& json, const std::string& name,
                       size_t from = 0) {
    const std::string key = "\"" + name + "\": ";
    const size_t at = json.find(key, from);
    return at == std::string::npos ? std::nan("")
                                   : std::stod(json.substr(at + key.size()));
  }

  TemporaryFolder folder_;
  SphereWorkspace sphere_;
  std::string program_;
};

TEST_F(MeshEvaluatorTest, ExplainsItsOptions) {
  const Outcome outcome = Run("-h");
  EXPECT_EQ(outcome.exit_code, 0);
  for (const char* option :
       {"--mesh_path", "--truth_path", "--workspace_path", "--json_path",
        "--observability_mask", "--MeshEvaluation.max_distance"}) {
    EXPECT_NE(outcome.out.find(option), std::string::npos) << option;
  }
}

TEST_F(MeshEvaluatorTest, MeasuresWholeSurfaces) {
  const Outcome outcome = Run(Basics() + Option("json_path", "figures.json"));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  for (const char* text : {"accuracy  completeness", "average score",
                           "2-manifold", "90th percentile"}) {
    EXPECT_NE(outcome.out.find(text), std::string::npos) << text;
  }
  const std::string json = ReadFile(Path("figures.json"));
  EXPECT_NEAR(Number(json, "mean"), 0.01, 1e-4);
  EXPECT_NEAR(Number(json, "average_score"), 0.01, 1e-4);
  EXPECT_EQ(Number(json, "num_components"), 1);
  EXPECT_NE(json.find("\"depths\": null"), std::string::npos);
}

TEST_F(MeshEvaluatorTest, MeasuresWhatCamerasSee) {
  const std::string arguments = Basics() +
                                Option("workspace_path", "workspace") +
                                Option("json_path", "figures.json") +
                                " --MeshEvaluation.depth_thresholds 0.001,0.5";
  const Outcome outcome = Run(arguments);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::string json = ReadFile(Path("figures.json"));
  EXPECT_NEAR(Number(json, "average_score"), 0.01, 1e-3);
  EXPECT_EQ(nlohmann::json::parse(json)["depths"]["shares"],
            (std::vector<double>{0, 1}));
  for (const char* num_threads : {"1", "2", "3"}) {
    ASSERT_EQ(Run(arguments + " --MeshEvaluation.num_threads " + num_threads)
                  .exit_code,
              0);
    EXPECT_EQ(ReadFile(Path("figures.json")), json);
  }
}

TEST_F(MeshEvaluatorTest, TakesDepthMapsAsTheTruth) {
  for (const SphereWorkspace::Image& image : sphere_.images) {
    std::string bytes = std::to_string(image.view.width) + "&" +
                        std::to_string(image.view.height) + "&1&";
    const float depth = static_cast<float>(image.view.Center().norm() - 1);
    for (int i = 0; i < image.view.width * image.view.height; ++i) {
      Append(depth, &bytes);
    }
    WriteFile(Path("depths") / (image.view.name + ".bin"), bytes);
  }
  const std::string arguments = Option("mesh_path", "mesh.ply") +
                                Option("truth_path", "depths") +
                                Option("workspace_path", "workspace");
  const Outcome outcome = Run(arguments + Option("json_path", "figures.json") +
                              " --MeshEvaluation.depth_thresholds 2");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::string json = ReadFile(Path("figures.json"));
  EXPECT_EQ(Number(json, "num_depths"),
            7.0 * ((sphere_.images[0].view.width + 1) / 3) *
                ((sphere_.images[0].view.height + 1) / 3));
  EXPECT_GT(Number(json, "num_missing"), 0);
  EXPECT_NE(json.find("\"accuracy\": null"), std::string::npos);
  ExpectRefusal(Run(arguments + Option("picture_path", "p.png")),
                "--picture_path");
  ExpectRefusal(
      Run(Option("mesh_path", "mesh.ply") + Option("truth_path", "depths")),
      "--workspace_path");
  ExpectRefusal(
      Run(Option("mesh_path", "mesh.ply") + Option("truth_path", "workspace") +
          Option("workspace_path", "workspace")),
      "no depth map");
}

TEST_F(MeshEvaluatorTest, DrawsTheErrors) {
  const Outcome outcome =
      Run(Basics() + Option("error_mesh_path", "errors.ply") +
          Option("picture_path", "errors.png"));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const PlyCloud errors = ReadPlyCloud(Path("errors.ply"));
  ASSERT_EQ(errors.colors.size(), Sphere(1).vertices.size());
  const auto size = ReadPictureSize(Path("errors.png"));
  ASSERT_TRUE(size);
  EXPECT_EQ(size->width, 1024);
  ASSERT_EQ(Run(Basics() + Option("workspace_path", "workspace") +
                Option("picture_path", "errors.png") + " --picture_image " +
                sphere_.images[2].view.name)
                .exit_code,
            0);
}

TEST_F(MeshEvaluatorTest, RestrictsToARegion) {
  const std::string json = Option("json_path", "figures.json");
  ASSERT_EQ(Run(Basics() + json).exit_code, 0);
  const double all = Number(ReadFile(Path("figures.json")), "num_samples");
  ASSERT_EQ(Run(Basics() + json + " --region=-2,-2,0,2,2,2").exit_code, 0);
  const std::string half = ReadFile(Path("figures.json"));
  EXPECT_NEAR(Number(half, "num_samples") / all, 0.5, 0.05);
  EXPECT_NEAR(Number(half, "num_samples", half.find("completeness")) / all, 0.5,
              0.05);
  ExpectRefusal(Run(Basics() + " --region auto"), "--workspace_path");
}

TEST_F(MeshEvaluatorTest, RestrictsToMaskAndPlane) {
  std::string header =
      "{'descr': '|u1', 'fortran_order': False, 'shape': (2, 1, 1), }\n";
  std::string mask("\x93NUMPY\x01\x00", 8);
  Append(static_cast<uint16_t>(header.size()), &mask);
  WriteFile(Path("mask.npy"), mask + header + std::string("\x00\x01", 2));
  const std::string json = Option("json_path", "figures.json");
  ASSERT_EQ(Run(Basics() + json).exit_code, 0);
  const double all = Number(ReadFile(Path("figures.json")), "num_samples");
  ASSERT_EQ(Run(Basics() + json + Option("observability_mask", "mask.npy") +
                " --observability_box=-2,0,0,4 --ground_plane=0,0,1,0")
                .exit_code,
            0);
  const std::string half = ReadFile(Path("figures.json"));
  EXPECT_NEAR(Number(half, "num_samples") / all, 0.5, 0.05);
  EXPECT_NEAR(Number(half, "num_samples", half.find("completeness")) / all, 0.5,
              0.05);
}

TEST_F(MeshEvaluatorTest, RefusesWhatItCanNotUse) {
  ExpectRefusal(Run(""), "--mesh_path and --truth_path are required");
  ExpectRefusal(Run(Basics() + " --MeshEvaluation.stride 0"), "stride");
  ExpectRefusal(Run(Basics() + " --MeshEvaluation.depth_thresholds 1,x"),
                "depth_thresholds");
  ExpectRefusal(Run(Basics() + " --MeshEvaluation.num_threads 0"),
                "num_threads");
  ExpectRefusal(Run(Basics() + " --ground_plane 1,2"), "4 numbers");
  ExpectRefusal(Run(Basics() + " --observability_box 1,2,3,4"),
                "--observability_mask");
  ExpectRefusal(Run(Basics() + " --picture_image x"), "--image_name");
  ExpectRefusal(Run(Basics() + Option("workspace_path", "none")),
                "no such folder");
  ExpectRefusal(Run(Basics() + " --json_path /dev/null/x"), "not a folder");
  ExpectRefusal(
      Run(Option("mesh_path", "none.ply") + Option("truth_path", "truth.ply")),
      "no such file");
  ExpectRefusal(
      Run(Option("mesh_path", "mesh.ply") + Option("truth_path", "none.ply")),
      "no such file");
  WriteColoredMesh(Path("points.ply"), {Sphere(1).vertices, {}}, {});
  ExpectRefusal(
      Run(Option("mesh_path", "points.ply") + Option("truth_path", "mesh.ply")),
      "no faces");
  ExpectRefusal(
      Run(Option("mesh_path", "mesh.ply") + Option("truth_path", "truth.ply") +
          " --MeshEvaluation.spacing 1e-9"),
      "too small");
  TriangleMesh away = Sphere(1);
  for (Eigen::Vector3f& vertex : away.vertices) {
    vertex.z() += 1000;
  }
  WriteColoredMesh(Path("truth.ply"), away, {});
  ExpectRefusal(Run(Basics() + Option("workspace_path", "workspace")),
                "same frame");
}

}  // namespace mesh_evaluator_test
}  // namespace colmap_ext
