#include "viewer/orbit_camera.h"

#include <numbers>

#include <gtest/gtest.h>
#include <Eigen/LU>

#include "scene/view.h"

namespace colmap_ext::orbit_camera_test {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kWidth = 640;
constexpr int kHeight = 480;

View Somewhere() {
  return LookAtView({3, -2, 1.5}, {0.2, 0.1, -0.3}, {0, 0, 1}, kWidth, kHeight,
                    700);
}

Vector2d Pixel(const View& view, const Vector3d& point) {
  return view.ImageFromCam(view.CamFromWorld(point));
}

bool IsRotation(const Eigen::Matrix3d& matrix) {
  return (matrix * matrix.transpose()).isIdentity(1e-9) &&
         matrix.determinant() > 0;
}

TEST(OrbitCamera, SeesAllOfItsViewWithItsIntrinsics) {
  const View view = Somewhere();
  const OrbitCamera camera(view, {0, 0, 0});
  const View same = camera.Picture(kWidth, kHeight);
  EXPECT_DOUBLE_EQ(same.fx, view.fx);
  EXPECT_DOUBLE_EQ(same.cx, view.cx);
  EXPECT_DOUBLE_EQ(same.cy, view.cy);
  const View wide = camera.Picture(2 * kWidth, kHeight);
  EXPECT_DOUBLE_EQ(wide.fx, view.fx);
  EXPECT_DOUBLE_EQ(wide.cx, view.cx + 0.5 * kWidth);
}

TEST(OrbitCamera, OrbitingKeepsThePivotInItsPixelAndItsDistance) {
  const Vector3d pivot(0.3, -0.2, 0.1);
  OrbitCamera camera(Somewhere(), pivot);
  const Vector2d before = Pixel(camera.Picture(kWidth, kHeight), pivot);
  const double distance = (Somewhere().Center() - pivot).norm();
  for (const Vector2d& to :
       {Vector2d(400, 100), Vector2d(10, 470), Vector2d(-50, 900)}) {
    camera.Orbit({300, 250}, to, kWidth, kHeight);
    const View view = camera.Picture(kWidth, kHeight);
    EXPECT_TRUE(IsRotation(view.cam_from_world_rotation));
    EXPECT_NEAR((Pixel(view, pivot) - before).norm(), 0, 1e-6);
    EXPECT_NEAR((view.Center() - pivot).norm(), distance, 1e-9);
  }
}

TEST(OrbitCamera, TheSurfaceFollowsTheFinger) {
  const Vector3d pivot(0.2, 0.1, -0.3);
  OrbitCamera camera(Somewhere(), pivot);
  const View before = camera.Picture(kWidth, kHeight);
  // A point before the pivot, seen in the middle.
  const Vector3d point = pivot + 0.2 * (before.Center() - pivot).normalized();
  camera.Orbit({320, 240}, {350, 240}, kWidth, kHeight);
  const View right = camera.Picture(kWidth, kHeight);
  EXPECT_GT(Pixel(right, point).x(), Pixel(before, point).x() + 1);
  camera.Orbit({320, 240}, {320, 200}, kWidth, kHeight);
  EXPECT_LT(Pixel(camera.Picture(kWidth, kHeight), point).y(),
            Pixel(right, point).y() - 1);
}

TEST(OrbitCamera, PanningMovesThePivotWithTheMouse) {
  const Vector3d pivot(0.2, 0.1, -0.3);
  OrbitCamera camera(Somewhere(), pivot);
  const Vector2d before = Pixel(camera.Picture(800, 300), pivot);
  camera.Pan({100, 100}, {130, 80}, 800, 300);
  EXPECT_NEAR(
      (Pixel(camera.Picture(800, 300), pivot) - before - Vector2d(30, -20))
          .norm(),
      0, 1e-6);
  // What it turns around is still in the middle of what is seen.
  EXPECT_NEAR((Pixel(camera.Picture(800, 300), camera.Pivot()) - before).norm(),
              0, 1e-6);
}

TEST(OrbitCamera, ZoomingBackAndForthIsNothing) {
  OrbitCamera camera(Somewhere(), {0, 0, 0});
  const double distance = Somewhere().Center().norm();
  camera.Zoom(3);
  const double near = camera.Picture(kWidth, kHeight).Center().norm();
  EXPECT_LT(near, distance);
  EXPECT_GT(near, 0);
  camera.Zoom(-3);
  EXPECT_NEAR(
      (camera.Picture(kWidth, kHeight).Center() - Somewhere().Center()).norm(),
      0, 1e-9);
}

TEST(OrbitCamera, AFullTurnIsNothing) {
  OrbitCamera camera(Somewhere(), {1, 2, 3});
  for (int i = 0; i < 12; ++i) {
    camera.Turn(std::numbers::pi / 6, {1, 1, 0});
  }
  EXPECT_TRUE(camera.Picture(kWidth, kHeight)
                  .cam_from_world_rotation.isApprox(
                      Somewhere().cam_from_world_rotation, 1e-9));
}

TEST(BetweenViews, StartsAndEndsAtTheViews) {
  const View first = Somewhere();
  View second =
      LookAtView({-1, 4, 2}, {0, 0, 0}, {0, 0, 1}, kWidth, kHeight, 500);
  second.cx = 300;
  const View start = BetweenViews(first, second, 0);
  EXPECT_NEAR((start.Center() - first.Center()).norm(), 0, 1e-9);
  const View end = BetweenViews(first, second, 1);
  EXPECT_EQ(end.cam_from_world_rotation, second.cam_from_world_rotation);
  EXPECT_EQ(end.cx, second.cx);
  const View middle = BetweenViews(first, second, 0.5);
  EXPECT_TRUE(IsRotation(middle.cam_from_world_rotation));
  EXPECT_NEAR((middle.Center() - first.Center()).norm(),
              (middle.Center() - second.Center()).norm(), 1e-9);
}

TEST(PivotBefore, LiesOnTheAxis) {
  const View view = Somewhere();
  for (const Vector3d& point : {Vector3d(0, 0, 0), Vector3d(9, -6, 4)}) {
    const Vector3d pivot = PivotBefore(view, point);
    EXPECT_NEAR((Pixel(view, pivot) - Vector2d(view.cx, view.cy)).norm(), 0,
                1e-6);
    EXPECT_GT(view.CamFromWorld(pivot).z(), 0);
  }
}

}  // namespace colmap_ext::orbit_camera_test
