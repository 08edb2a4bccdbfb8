#include "pictures/picture_views.h"

#include <gtest/gtest.h>

#include "scene/look_at.h"
#include "tests/random.h"

namespace colmap_ext {
namespace {

using Eigen::Vector3d;

TEST(CropView, ScalesThePartThatIsAskedFor) {
  const View view = LookAtView({0, 0, 3}, {0, 0, 0}, {0, 1, 0}, 640, 480, 960);
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
  Random random(1);
  TriangleMesh mesh;
  for (int i = 0; i < 500; ++i) {
    mesh.vertices.emplace_back(7 + 3 * random.Unit(), 2 * random.Unit(),
                               random.Unit());
  }
  mesh.vertices.emplace_back(1e4f, 0, 0);  // a stray one
  const View view = AutomaticView(mesh, 400, 300);
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
