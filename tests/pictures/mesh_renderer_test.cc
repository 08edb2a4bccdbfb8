#include "pictures/mesh_renderer.h"

#include <gtest/gtest.h>

#include "tests/synthetic/noise.h"

namespace colmap_ext {
namespace {

using synthetic::Hash;
using synthetic::Uniform;

using Eigen::Vector3d;

// A square in the plane z = 0 whose front is seen from z > 0.
DrawnMesh Square() {
  DrawnMesh ply;
  ply.mesh.vertices = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  ply.mesh.facets = {{0, 1, 2}, {0, 2, 3}};
  return ply;
}

Color MiddlePixel(const DrawnMesh& ply, double z, RenderMode mode) {
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
  DrawnMesh ply = Square();
  EXPECT_EQ(MiddlePixel(ply, 3, RenderMode::kNormals), (Color{128, 128, 255}));
  ply.colors.assign(4, {10, 20, 30});
  EXPECT_EQ(MiddlePixel(ply, 3, RenderMode::kColor), (Color{10, 20, 30}));
}

TEST(RenderMesh, DrawsPointsOfClouds) {
  DrawnMesh ply;
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

}  // namespace
}  // namespace colmap_ext
