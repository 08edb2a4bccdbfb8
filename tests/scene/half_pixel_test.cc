#include "scene/half_pixel.h"

#include <cmath>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "tests/random.h"

namespace colmap_ext {
namespace half_pixel_test {

View MakeView(double fx, double fy) {
  View view;
  view.width = 1000;
  view.height = 800;
  view.fx = fx;
  view.fy = fy;
  view.cx = 480;
  view.cy = 410;
  return view;
}

void AddPoint(const Eigen::Vector3f& position,
              const std::vector<uint32_t>& views, PointCloud* cloud) {
  cloud->positions.push_back(position);
  cloud->views.AddRow(views);
}

TEST(View, CameraCenterIsTheOriginOfItsFrame) {
  View view = MakeView(500, 600);
  view.cam_from_world_rotation =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized())
          .toRotationMatrix();
  view.cam_from_world_translation = {4, -5, 6};
  EXPECT_LT(view.CamFromWorld(view.Center()).norm(), 1e-12);
  const Eigen::Vector2d pixel = view.ImageFromCam({0.2, -0.1, 2});
  EXPECT_DOUBLE_EQ(pixel.x(), 500 * 0.1 + 480);
  EXPECT_DOUBLE_EQ(pixel.y(), 600 * -0.05 + 410);
}

TEST(HalfPixelOffsets, OfOneView) {
  PointCloud cloud;
  AddPoint({1, 2, 4}, {0}, &cloud);
  const std::vector<View> views = {MakeView(100, 200)};
  // 4 / 100 and 4 / 200 are a pixel's width and height there.
  EXPECT_TRUE(HalfPixelOffsets(cloud, views)[0].isApprox(
      Eigen::Vector3f(0.02f, 0.01f, 0)));
  // Depth maps of half the size have pixels of twice the size.
  EXPECT_TRUE(HalfPixelOffsets(cloud, views, {0.5})[0].isApprox(
      Eigen::Vector3f(0.04f, 0.02f, 0)));
}

TEST(HalfPixelOffsets, AreTheMeanOverTheViews) {
  PointCloud cloud;
  AddPoint({0, 0, 4}, {0, 1}, &cloud);
  AddPoint({0, 0, 4}, {1}, &cloud);
  AddPoint({0, 0, 4}, {}, &cloud);
  std::vector<View> views = {MakeView(100, 200), MakeView(50, 50)};
  // From the right: its right is the world's z, its down the world's y.
  views[1].cam_from_world_rotation << 0, 0, 1, 0, 1, 0, -1, 0, 0;
  views[1].cam_from_world_translation = {0, 0, 10};
  const auto offsets = HalfPixelOffsets(cloud, views);
  ASSERT_EQ(offsets.size(), 3u);
  EXPECT_TRUE(offsets[1].isApprox(Eigen::Vector3f(0, 0.1f, 0.1f)));
  EXPECT_TRUE(offsets[0].isApprox(Eigen::Vector3f(0.01f, 0.055f, 0.05f)));
  EXPECT_TRUE(offsets[2].isZero());
}

TEST(HalfPixelOffsets, MoveThePointByHalfAPixelInItsView) {
  Random random(1);
  for (int trial = 0; trial < 100; ++trial) {
    View view = MakeView(500 + 500 * random.Unit(), 700);
    view.cam_from_world_rotation =
        Eigen::AngleAxisd(
            6 * random.Unit(),
            Eigen::Vector3d(random.Unit(), random.Unit(), 1).normalized())
            .toRotationMatrix();
    view.cam_from_world_translation = {0, 0, 5};
    PointCloud cloud;
    AddPoint(Eigen::Vector3d(random.Unit(), random.Unit(), random.Unit())
                 .cast<float>(),
             {0}, &cloud);
    const Eigen::Vector3d point = cloud.positions[0].cast<double>();
    const Eigen::Vector3d moved =
        point + HalfPixelOffsets(cloud, {view})[0].cast<double>();
    const Eigen::Vector2d shift = view.ImageFromCam(view.CamFromWorld(moved)) -
                                  view.ImageFromCam(view.CamFromWorld(point));
    EXPECT_NEAR(shift.x(), 0.5, 1e-4);
    EXPECT_NEAR(shift.y(), 0.5, 1e-4);
    EXPECT_NEAR(view.CamFromWorld(moved).z(), view.CamFromWorld(point).z(),
                1e-6);
  }
}

}  // namespace half_pixel_test
}  // namespace colmap_ext
