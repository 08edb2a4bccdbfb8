#include "tests/synthetic/mesh_renderer.h"

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "tests/synthetic/noise.h"

namespace colmap_ext::synthetic {
namespace {

using Eigen::Vector3d;

// A square in the plane z = 0 whose front is seen from z > 0.
PlyMesh Square() {
  PlyMesh ply;
  ply.mesh.vertices = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  ply.mesh.facets = {{0, 1, 2}, {0, 2, 3}};
  return ply;
}

Color MiddlePixel(const PlyMesh& ply, double z, RenderMode mode) {
  const View view = LookAtView({0.1, 0, z}, {0.1, 0, 0}, {0, 1, 0}, 64, 48);
  return RenderMesh(ply, view, mode, 2).At(24, 32);
}

bool IsRed(const Color& color) {
  return color[0] > 2 * color[1] && color[0] > 2 * color[2];
}

TEST(RenderMesh, BackFacesAreRed) {
  for (const RenderMode mode : {RenderMode::kShaded, RenderMode::kNormals,
                                RenderMode::kColor, RenderMode::kLabels}) {
    EXPECT_FALSE(IsRed(MiddlePixel(Square(), 3, mode)));
    EXPECT_TRUE(IsRed(MiddlePixel(Square(), -3, mode)));
  }
}

TEST(RenderMesh, NormalsAndColors) {
  PlyMesh ply = Square();
  EXPECT_EQ(MiddlePixel(ply, 3, RenderMode::kNormals), (Color{128, 128, 255}));
  ply.colors.assign(4, {10, 20, 30});
  EXPECT_EQ(MiddlePixel(ply, 3, RenderMode::kColor), (Color{10, 20, 30}));
}

TEST(RenderMesh, DrawsPointsOfClouds) {
  PlyMesh ply;
  ply.mesh.vertices = {{0.1f, 0, 0}, {0.1f, 0, -1}};
  ply.colors = {{10, 20, 30}, {200, 200, 200}};
  EXPECT_EQ(MiddlePixel(ply, 3, RenderMode::kShaded), (Color{10, 20, 30}));
  EXPECT_EQ(MiddlePixel(ply, -3, RenderMode::kShaded), (Color{200, 200, 200}));
}

TEST(CropView, ScalesThePartThatIsAskedFor) {
  const View view = LookAtView({0, 0, 3}, {0, 0, 0}, {0, 1, 0}, 640, 480);
  const View crop = CropView(view, 4, 0.25, 0.75, 320, 240);
  const Vector3d point =
      view.cam_from_world_rotation.transpose() *
      (Vector3d((160 - view.cx) / view.fx, (360 - view.cy) / view.fy, 1) -
       view.cam_from_world_translation);
  const Eigen::Vector2d middle = crop.ImageFromCam(crop.CamFromWorld(point));
  EXPECT_NEAR(middle.x(), 160, 1e-9);
  EXPECT_NEAR(middle.y(), 120, 1e-9);
  EXPECT_NEAR(crop.fx, 2 * view.fx, 1e-9);
}

TEST(AutomaticView, HasTheMeshInItsPicture) {
  TriangleMesh mesh;
  for (int i = 0; i < 500; ++i) {
    mesh.vertices.emplace_back(7 + 3 * Uniform(Hash(1, i)),
                               2 * Uniform(Hash(2, i)), Uniform(Hash(3, i)));
  }
  mesh.vertices.emplace_back(1e4f, 0, 0);  // a stray one
  const View view = AutomaticView({mesh, {}, {}, {}}, 400, 300);
  for (int i = 0; i < 500; ++i) {
    const Vector3d p = view.CamFromWorld(mesh.vertices[i].cast<double>());
    ASSERT_GT(p.z(), 0);
    const Eigen::Vector2d pixel = view.ImageFromCam(p);
    EXPECT_GT(pixel.minCoeff(), -15);
    EXPECT_LT(pixel.x(), 415);
    EXPECT_LT(pixel.y(), 315);
  }
}

class PlyMeshFile : public testing::Test {
 protected:
  ~PlyMeshFile() override { std::filesystem::remove(path_); }

  void Write(const std::string& text) {
    std::ofstream(path_, std::ios::binary) << text;
  }

  const std::string path_ =
      (std::filesystem::path(testing::TempDir()) /
       (std::string("ply_mesh_") +
        testing::UnitTest::GetInstance()->current_test_info()->name() + ".ply"))
          .string();
};

TEST_F(PlyMeshFile, IsReadAsWritten) {
  const TriangleMesh mesh = Square().mesh;
  WritePlyMesh(path_, mesh);
  const PlyMesh read = ReadPlyMesh(path_);
  EXPECT_EQ(read.mesh.vertices, mesh.vertices);
  EXPECT_EQ(read.mesh.facets, mesh.facets);
}

TEST_F(PlyMeshFile, TextWithColorsLabelsAndAQuadrilateral) {
  Write(
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty uchar red\n"
      "property uchar green\nproperty uchar blue\nproperty float x\n"
      "property float y\nproperty float z\nelement face 1\n"
      "property list uchar int vertex_indices\nproperty int label\n"
      "end_header\n1 2 3 0 0 0\n1 2 3 1 0 0\n1 2 3 1 1 0\n1 2 3 0 1 0\n"
      "4 0 1 2 3 7\n");
  const PlyMesh ply = ReadPlyMesh(path_);
  EXPECT_EQ(ply.colors[3], (Color{1, 2, 3}));
  EXPECT_EQ(ply.mesh.vertices[2], Eigen::Vector3f(1, 1, 0));
  ASSERT_EQ(ply.mesh.facets.size(), 2);
  EXPECT_EQ(ply.mesh.facets[1], (Facet{0, 2, 3}));
  EXPECT_EQ(ply.labels, (std::vector<int32_t>{7, 7}));
}

TEST_F(PlyMeshFile, RefusesWhatIsBroken) {
  EXPECT_THROW(ReadPlyMesh(path_), std::runtime_error);
  Write("hello");
  EXPECT_THROW(ReadPlyMesh(path_), std::runtime_error);
  WritePlyMesh(path_, Square().mesh);
  std::filesystem::resize_file(path_, std::filesystem::file_size(path_) - 1);
  EXPECT_THROW(ReadPlyMesh(path_), std::runtime_error);
  TriangleMesh mesh = Square().mesh;
  mesh.facets[0][0] = 4;
  WritePlyMesh(path_, mesh);
  EXPECT_THROW(ReadPlyMesh(path_), std::runtime_error);
}

}  // namespace
}  // namespace colmap_ext::synthetic
