// mesh_evaluator as a user runs it: exit codes, messages, files.

#include <nlohmann/json.hpp>

#include "formats/picture_files.h"
#include "formats/read_ply.h"
#include "formats/write_mesh.h"
#include "tests/colmap_ext/run_shell.h"
#include "tests/mesh/known_meshes.h"
#include "tests/workspace/sphere_workspace.h"

namespace colmap_ext::mesh_evaluator_test {

namespace fs = std::filesystem;

// A sphere around the origin.
TriangleMesh Sphere(float radius) {
  return Scaled(MakeBumpySphere(0.1F, 0), radius);
}

struct MeshEvaluatorTest : testing::Test {
  MeshEvaluatorTest() {
    WriteColoredMesh(Path("mesh.ply"), Sphere(1.01f), {});
    WriteColoredMesh(Path("truth.ply"), Sphere(1), {});
    sphere_.Write(Path("workspace"));
  }

  fs::path Path(const std::string& name) const { return folder_.Path() / name; }

  std::string Option(const std::string& option, const std::string& name) const {
    return PathOption(option, Path(name));
  }

  static Outcome Run(const std::string& arguments) {
    return RunProgram("mesh_evaluator " + arguments);
  }

  std::string Meshes(const std::string& mesh, const std::string& truth) const {
    return Option("mesh_path", mesh) + Option("truth_path", truth);
  }

  // Mesh, truth, a spacing for quick tests.
  std::string Basics() const {
    return Meshes("mesh.ply", "truth.ply") + " @spacing 0.05";
  }

  // The figures of a run.
  nlohmann::json Evaluate(const std::string& arguments) const {
    Succeed(Run(arguments + Option("json_path", "figures.json")));
    return nlohmann::json::parse(ReadFile(Path("figures.json")));
  }

  void ExpectHalfOfTheSamples(const std::string& options) const {
    const double all = Evaluate(Basics())["accuracy"]["num_samples"];
    const nlohmann::json half = Evaluate(Basics() + options);
    for (const char* name : {"accuracy", "completeness"}) {
      const double num_samples = half[name]["num_samples"];
      EXPECT_NEAR(num_samples / all, 0.5, 0.05) << name;
    }
  }

  TemporaryFolder folder_;
  SphereWorkspace sphere_;
};

TEST_F(MeshEvaluatorTest, MeasuresWholeSurfaces) {
  EXPECT_TRUE(
      HasAll(Run(Basics()).out, {"accuracy  completeness", "average score",
                                 "2-manifold", "90th percentile"}));
  const nlohmann::json json = Evaluate(Basics());
  EXPECT_NEAR(json["accuracy"]["mean"], 0.01, 1e-4);
  EXPECT_NEAR(json["average_score"], 0.01, 1e-4);
  EXPECT_EQ(json["topology"]["num_components"], 1);
  EXPECT_TRUE(json["depths"].is_null());
}

TEST_F(MeshEvaluatorTest, MeasuresWhatCamerasSee) {
  const std::string arguments = Basics() +
                                Option("workspace_path", "workspace") +
                                " @depth_thresholds 0.001,0.5";
  const nlohmann::json json = Evaluate(arguments);
  EXPECT_NEAR(json["average_score"], 0.01, 1e-3);
  EXPECT_EQ(json["depths"]["shares"], (std::vector<double>{0, 1}));
  const std::string bytes = ReadFile(Path("figures.json"));
  for (const char* num_threads : {"1", "2", "3"}) {
    Evaluate(arguments + " @num_threads " + num_threads);
    EXPECT_EQ(ReadFile(Path("figures.json")), bytes);
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
  const std::string arguments =
      Meshes("mesh.ply", "depths") + Option("workspace_path", "workspace");
  const nlohmann::json json = Evaluate(arguments + " @depth_thresholds 2");
  EXPECT_EQ(json["depths"]["num_depths"],
            7.0 * ((sphere_.images[0].view.width + 1) / 3) *
                ((sphere_.images[0].view.height + 1) / 3));
  EXPECT_GT(json["depths"]["num_missing"], 0);
  EXPECT_TRUE(json["accuracy"].is_null());
  ExpectRefusal(Run(arguments + Option("picture_path", "p.png")),
                "--picture_path");
  ExpectRefusal(Run(Meshes("mesh.ply", "depths")), "--workspace_path");
  ExpectRefusal(Run(Meshes("mesh.ply", "workspace") +
                    Option("workspace_path", "workspace")),
                "no depth map");
}

TEST_F(MeshEvaluatorTest, DrawsTheErrors) {
  Succeed(Run(Basics() + Option("error_mesh_path", "errors.ply") +
              Option("picture_path", "errors.png")));
  const PlyCloud errors = ReadPlyCloud(Path("errors.ply"));
  ASSERT_EQ(errors.colors.size(), Sphere(1).vertices.size());
  const auto size = ReadPictureSize(Path("errors.png"));
  ASSERT_TRUE(size);
  EXPECT_EQ(size->width, 1024);
  Succeed(Run(Basics() + Option("workspace_path", "workspace") +
              Option("picture_path", "errors.png") + " --image_name " +
              sphere_.images[2].view.name));
}

TEST_F(MeshEvaluatorTest, RestrictsToARegionOrAMaskAndAPlane) {
  ExpectHalfOfTheSamples(" --region=-2,-2,0,2,2,2");
  ExpectRefusal(Run(Basics() + " --region auto"), "--workspace_path");
  std::string header =
      "{'descr': '|u1', 'fortran_order': False, 'shape': (2, 1, 1), }\n";
  std::string mask("\x93NUMPY\x01\x00", 8);
  Append(static_cast<uint16_t>(header.size()), &mask);
  WriteFile(Path("mask.npy"), mask + header + std::string("\x00\x01", 2));
  ExpectHalfOfTheSamples(
      Option("observability_mask", "mask.npy") +
      " --observability_box=-2,0,0,4 --ground_plane=0,0,1,0");
}

TEST_F(MeshEvaluatorTest, RefusesWhatItCanNotUse) {
  ExpectRefusal(Run(Basics() + " --ground_plane 1,2"), "4 numbers");
  ExpectRefusal(Run(Basics() + Option("workspace_path", "none")),
                "no such folder");
  ExpectRefusal(Run(Basics() + " --json_path /dev/null/x"), "not a folder");
  ExpectRefusal(Run(Meshes("none.ply", "truth.ply")), "no such file");
  ExpectRefusal(Run(Meshes("mesh.ply", "none.ply")), "no such file");
  WriteColoredMesh(Path("points.ply"), {Sphere(1).vertices, {}}, {});
  ExpectRefusal(Run(Meshes("points.ply", "mesh.ply")), "no faces");
  ExpectRefusal(Run(Meshes("mesh.ply", "truth.ply") + " @spacing 1e-9"),
                "too small");
  WriteColoredMesh(Path("truth.ply"), Shifted(Sphere(1), {0, 0, 1000}), {});
  ExpectRefusal(Run(Basics() + Option("workspace_path", "workspace")),
                "same frame");
}

}  // namespace colmap_ext::mesh_evaluator_test
