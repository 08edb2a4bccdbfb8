#include "pictures/picture_views.h"

#include <gtest/gtest.h>

#include "scene/look_at.h"
#include "tests/random.h"

namespace colmap_ext {
namespace picture_views_test {

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

// Views at these places along a line.
std::vector<View> ViewsAt(const std::vector<double>& places) {
  std::vector<View> views;
  for (const double x : places) {
    views.push_back(LookAtView({x, 0, 5}, {x, 0, 0}, {0, 1, 0}, 640, 480, 960));
  }
  return views;
}

TEST(SpreadViews, AreFarApartOfThoseThatSeeMuch) {
  const std::vector<View> views = ViewsAt({0, 1, 2, 3, 4, 50});
  const std::vector<size_t> num_seen = {5, 5, 9, 5, 6, 4};
  EXPECT_EQ(SpreadViews(views, num_seen, 1), (std::vector<size_t>{2}));
  EXPECT_EQ(SpreadViews(views, num_seen, 3), (std::vector<size_t>{2, 0, 4}));
  EXPECT_EQ(SpreadViews(views, num_seen, 9).size(), 5);
}

TEST(SpreadViews, DoWithFewViews) {
  EXPECT_TRUE(SpreadViews({}, {}, 3).empty());
  EXPECT_TRUE(SpreadViews(ViewsAt({0, 1}), {0, 0}, 3).empty());
  EXPECT_EQ(SpreadViews(ViewsAt({0, 1}), {0, 7}, 3), (std::vector<size_t>{1}));
  EXPECT_EQ(SpreadViews(ViewsAt({1, 1, 1}), {7, 7, 7}, 3),
            (std::vector<size_t>{0}))
      << "all at one place";
}

}  // namespace picture_views_test
}  // namespace colmap_ext
