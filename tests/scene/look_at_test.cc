#include "scene/look_at.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "tests/random.h"

namespace colmap_ext {
namespace look_at_test {

using Eigen::Vector3d;

Vector3d RandomVector(Random* random) {
  return {2 * random->Unit() - 1, 2 * random->Unit() - 1,
          2 * random->Unit() - 1};
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

}  // namespace look_at_test
}  // namespace colmap_ext
