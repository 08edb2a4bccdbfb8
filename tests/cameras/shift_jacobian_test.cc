#include "cameras/camera_set.h"

#include <functional>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "tests/cameras/camera_scene.h"

namespace colmap_ext {
namespace shift_jacobian_test {

View MakeView(const Eigen::Vector3d& center, double focal) {
  View view;
  view.width = 640;
  view.height = 480;
  view.fx = focal;
  view.fy = 1.1 * focal;
  view.cx = 310;
  view.cy = 250;
  view.cam_from_world_rotation =
      (Eigen::AngleAxisd(0.1 * center.x(), Eigen::Vector3d::UnitY()) *
       Eigen::AngleAxisd(0.2 * center.y(), Eigen::Vector3d::UnitX()))
          .toRotationMatrix();
  view.cam_from_world_translation = -view.cam_from_world_rotation * center;
  return view;
}

// Where j shows the point of a plane that a pixel of i shows.
Eigen::Vector2d Warp(const View& i, const View& j, const Eigen::Vector2d& pixel,
                     const Eigen::Vector3d& on_plane,
                     const Eigen::Vector3d& normal) {
  const Eigen::Vector3d ray =
      i.RayFromPixel() * Eigen::Vector3d(pixel.x(), pixel.y(), 1);
  const Eigen::Vector3d center = i.Center();
  const Eigen::Vector3d point =
      center + normal.dot(on_plane - center) / normal.dot(ray) * ray;
  return j.ImageFromCam(j.CamFromWorld(point));
}

class ShiftJacobianTest : public testing::Test {
 protected:
  const View i_ = MakeView({-0.6, 0.1, -3}, 500);
  const View j_ = MakeView({0.7, -0.2, -3.3}, 600);
  const Eigen::Vector3d point_{0.3, -0.2, 0.4};
  const Eigen::Vector3d normal_ = Eigen::Vector3d(0.3, 0.2, -0.9).normalized();
  const Eigen::Vector2d pixel_ = i_.ImageFromCam(i_.CamFromWorld(point_));
  const ShiftJacobian jacobian_ = ComputeShiftJacobian(i_, j_, point_, normal_);

  // Central differences of a warp by its parameter.
  static Eigen::Vector2d Differentiate(
      const std::function<Eigen::Vector2d(double)>& warp) {
    constexpr double kStep = 1e-6;
    return (warp(kStep) - warp(-kStep)) / (2 * kStep);
  }

  // \param move  a view by a size along a parameter k.
  template <typename Jacobian, typename Move>
  void ExpectByEither(const Jacobian& by_i, const Jacobian& by_j,
                      const Move& move) const {
    for (int k = 0; k < by_i.cols(); ++k) {
      const Eigen::Vector2d of_i = Differentiate([&](double size) {
        return Warp(move(i_, size, k), j_, pixel_, point_, normal_);
      });
      const Eigen::Vector2d of_j = Differentiate([&](double size) {
        return Warp(i_, move(j_, size, k), pixel_, point_, normal_);
      });
      EXPECT_LT((of_i - by_i.col(k)).norm(), 1e-4) << k;
      EXPECT_LT((of_j - by_j.col(k)).norm(), 1e-4) << k;
    }
  }
};

TEST_F(ShiftJacobianTest, IsTheDerivativeByEitherPose) {
  ExpectByEither(jacobian_.by_pose_i, jacobian_.by_pose_j,
                 [](const View& view, double size, int k) {
                   return MoveView(view, size * PoseStep::Unit(k),
                                   IntrinsicsStep::Zero());
                 });
}

TEST_F(ShiftJacobianTest, IsTheDerivativeByEitherCamera) {
  ExpectByEither(jacobian_.by_intrinsics_i, jacobian_.by_intrinsics_j,
                 [](const View& view, double size, int k) {
                   return MoveView(view, PoseStep::Zero(),
                                   size * IntrinsicsStep::Unit(k));
                 });
}

TEST_F(ShiftJacobianTest, IsTheDerivativeByTheDisplacementAndThePixel) {
  const Eigen::Vector2d by_displacement = Differentiate([&](double size) {
    return Warp(i_, j_, pixel_, point_ + size * normal_, normal_);
  });
  EXPECT_LT((by_displacement - jacobian_.by_displacement).norm(), 1e-4);
  for (int k = 0; k < 2; ++k) {
    const Eigen::Vector2d by_pixel = Differentiate([&](double size) {
      return Warp(i_, j_, pixel_ + size * Eigen::Vector2d::Unit(k), point_,
                  normal_);
    });
    EXPECT_LT((by_pixel - jacobian_.by_pixel_i.col(k)).norm(), 1e-6);
  }
}

// A motion of all cameras together, which the world does not see, is the one
// that moves no pixel if the plane goes with it.
TEST_F(ShiftJacobianTest, MotionAlongTheRayIsTheDisplacements) {
  const Eigen::Vector3d along =
      i_.cam_from_world_rotation * (point_ - i_.Center());
  PoseStep step = PoseStep::Zero();
  step.tail<3>() = along;
  EXPECT_LT((jacobian_.by_pose_i * step).norm(), 1e-9);
}

TEST(MoveView, GoesTheStepBetweenTwoViews) {
  const View from = MakeView({-0.6, 0.1, -3}, 500);
  const View to = MakeView({0.7, -0.2, -3.3}, 500);
  const View moved =
      MoveView(from, StepBetween(from, to), IntrinsicsStep::Zero());
  EXPECT_TRUE(moved.cam_from_world_rotation.isApprox(to.cam_from_world_rotation,
                                                     1e-12));
  EXPECT_TRUE(moved.cam_from_world_translation.isApprox(
      to.cam_from_world_translation, 1e-12));
}

}  // namespace shift_jacobian_test
}  // namespace colmap_ext
