#include "scene/view.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "scene/images.h"
#include "tests/random_vectors.h"

namespace colmap_ext {
namespace view_test {

using Eigen::Vector2d;
using Eigen::Vector3d;

View RandomView(Random* random) {
  View view;
  view.width = random->Integer(50, 200);
  view.height = random->Integer(50, 200);
  view.fx = 50 + 100 * random->Unit();
  view.fy = 50 + 100 * random->Unit();
  view.cx = view.width * random->Unit();
  view.cy = view.height * random->Unit();
  view.cam_from_world_rotation =
      Eigen::AngleAxisd(6 * random->Unit(), RandomNormal(random))
          .toRotationMatrix();
  view.cam_from_world_translation = 5 * RandomVector(random);
  return view;
}

// A point of the world that is a depth of `depth` in front of the camera.
Vector3d PointBefore(const View& view, double depth, Random* random) {
  const Vector3d in_camera(random->Unit() - 0.5, random->Unit() - 0.5, 1);
  return view.cam_from_world_rotation.transpose() *
         (depth * in_camera - view.cam_from_world_translation);
}

Vector2d Project(const View& view, const Vector3d& point) {
  return view.ImageFromCam(view.CamFromWorld(point));
}

TEST(View, PutsItsCenterAtTheOrigin) {
  Random random(1);
  for (int i = 0; i < 20; ++i) {
    const View view = RandomView(&random);
    EXPECT_LT(view.CamFromWorld(view.Center()).norm(), 1e-12);
  }
}

TEST(View, ShowsThePrincipalPointStraightAhead) {
  Random random(2);
  const View view = RandomView(&random);
  const Vector3d ahead =
      view.Center() + 3 * view.cam_from_world_rotation.row(2).transpose();
  EXPECT_LT((Project(view, ahead) - Vector2d(view.cx, view.cy)).norm(), 1e-9);
}

TEST(View, ImagesScaleWithTheFocalLengths) {
  View view;
  view.fx = 500;
  view.fy = 600;
  view.cx = 480;
  view.cy = 410;
  const Vector2d pixel = view.ImageFromCam({0.2, -0.1, 2});
  EXPECT_DOUBLE_EQ(pixel.x(), 500 * 0.1 + 480);
  EXPECT_DOUBLE_EQ(pixel.y(), 600 * -0.05 + 410);
}

TEST(View, RaysGoFromTheCenterThroughWhatIsSeenThere) {
  Random random(3);
  for (int i = 0; i < 50; ++i) {
    const View view = RandomView(&random);
    const double depth = 0.1 + 10 * random.Unit();
    const Vector3d point = PointBefore(view, depth, &random);
    const Vector2d pixel = Project(view, point);
    const Vector3d ray = view.RayFromPixel() * pixel.homogeneous();
    EXPECT_LT((view.Center() + depth * ray - point).norm(), 1e-9);
    EXPECT_LT(
        (RayDirection(view, pixel.x(), pixel.y()).cast<double>() - ray).norm(),
        1e-5);
  }
}

TEST(View, PixelsOfDirectionsAreThoseOfPointsAlongThem) {
  Random random(4);
  for (int i = 0; i < 50; ++i) {
    const View view = RandomView(&random);
    const Vector3d point = PointBefore(view, 1 + random.Unit(), &random);
    const Vector2d pixel =
        (view.PixelFromRay() * (point - view.Center())).hnormalized();
    EXPECT_LT((pixel - Project(view, point)).norm(), 1e-9);
    EXPECT_TRUE((view.PixelFromRay() * view.RayFromPixel()).isIdentity(1e-12));
  }
}

TEST(ResizeView, KeepsWhatIsSeenAtEachPlaceOfTheImage) {
  Random random(5);
  for (int i = 0; i < 50; ++i) {
    const View view = RandomView(&random);
    const View resized =
        ResizeView(view, random.Integer(1, 400), random.Integer(1, 400));
    const Vector3d point = PointBefore(view, 1 + random.Unit(), &random);
    const Eigen::Array2d size(view.width, view.height);
    const Eigen::Array2d new_size(resized.width, resized.height);
    EXPECT_LT((Project(view, point).array() / size -
               Project(resized, point).array() / new_size)
                  .matrix()
                  .norm(),
              1e-12);
    EXPECT_EQ(resized.Center(), view.Center());
  }
}

TEST(ResizeView, ToTheSameSizeChangesNothing) {
  Random random(6);
  const View view = RandomView(&random);
  const View same = ResizeView(view, view.width, view.height);
  EXPECT_EQ(same.width, view.width);
  EXPECT_EQ(same.height, view.height);
  EXPECT_EQ(same.PixelFromRay(), view.PixelFromRay());
}

TEST(GrayImage, HasItsRowsOneAfterTheOther) {
  const GrayImage image{3, 2, {1, 2, 3, 4, 5, 6}};
  EXPECT_EQ(image.Row(0)[2], 3);
  EXPECT_EQ(image.Row(1)[0], 4);
}

void ExpectLooksAt(const View& view, const Vector3d& eye,
                   const Vector3d& target) {
  const Eigen::Matrix3d& rotation = view.cam_from_world_rotation;
  EXPECT_TRUE((rotation * rotation.transpose()).isIdentity(1e-12));
  EXPECT_NEAR(rotation.determinant(), 1, 1e-12);
  EXPECT_TRUE(view.Center().isApprox(eye, 1e-12));
  const Vector3d in_camera = view.CamFromWorld(target);
  EXPECT_NEAR(in_camera.z(), (target - eye).norm(), 1e-12);
  EXPECT_TRUE(view.ImageFromCam(in_camera).isApprox(
      Eigen::Vector2d(0.5 * view.width, 0.5 * view.height), 1e-9));
}

TEST(LookAtView, HasTheTargetInItsMiddleAndUpUpwards) {
  Random random(1);
  for (int trial = 0; trial < 100; ++trial) {
    const Vector3d eye = RandomVector(&random);
    const Vector3d target = RandomVector(&random);
    const Vector3d up = RandomVector(&random);
    const View view = LookAtView(eye, target, up, 320, 240, 500);
    ExpectLooksAt(view, eye, target);
    const Vector3d up_in_camera = view.cam_from_world_rotation * up;
    EXPECT_NEAR(up_in_camera.x(), 0, 1e-9);
    EXPECT_LT(up_in_camera.y(), 0);  // rows go down
  }
}

TEST(LookAtView, MayLookAlongUp) {
  for (const double length : {0.0, 1.0, -5.0}) {
    ExpectLooksAt(
        LookAtView({1, 2, 3}, {1, 2, 7}, {0, 0, length}, 320, 240, 500),
        {1, 2, 3}, {1, 2, 7});
  }
}

}  // namespace view_test
}  // namespace colmap_ext
