#include "cameras/surface_patches.h"

#include <cmath>
#include <functional>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "cameras/camera_set.h"
#include "raster/facet_id_buffer.h"
#include "tests/cameras/camera_scene.h"

namespace colmap_ext::window_shift_test {

using Eigen::Vector2d;
using Eigen::Vector3d;

// A scene, its cameras a little off, and windows of it.
struct Windows {
  CameraScene scene = MakeCameraScene(false, 320);
  CameraSet cameras = Disturb(scene, scene.truth, 0.3, 1);
  PhotometricOptions photometric;
  PatchOptions options{.radius = 5, .max_patches_per_view = 50};
  std::shared_ptr<ImagePyramid> images = scene.scene.Pyramid();
  VisibilityBuffers buffers{scene.scene.Truth(), cameras.views,
                            photometric.min_cosine, SIZE_MAX};
  SurfacePatches patches =
      SelectPatches(options, photometric, {buffers, images.get()}, scene.pairs);

  FacetFrame FrameOf(uint32_t facet) const {
    return DrawnScene{buffers, images.get()}.FrameOf(facet);
  }

  WindowShift Compare(const std::vector<View>& views, const SurfacePatch& patch,
                      uint32_t j) const {
    const auto image_i = images->Image(patch.view);
    const auto image_j = images->Image(j);
    const auto drawn_i = buffers.Get(patch.view);
    const auto drawn_j = buffers.Get(j);
    return CompareWindow(
        photometric, options.radius,
        {views[patch.view], *image_i, *drawn_i, buffers.Mesh()},
        {views[j], *image_j, *drawn_j, buffers.Mesh()}, patch);
  }

  // Whether no pixel of a window is masked: the energy of others jumps as one
  // becomes hidden.
  bool IsWhole(const WindowShift& shift) const {
    const int side = 2 * options.radius + 1;
    return shift.is_valid && shift.num_pixels == side * side;
  }

  // Sum of 1 - ZNCC over the windows that are whole by the cameras.
  double Energy(const std::vector<View>& views) const {
    double sum = 0;
    for (size_t k = 0; k < patches.patches.size(); ++k) {
      for (const uint32_t j : patches.partners[k]) {
        if (IsWhole(Compare(cameras.views, patches.patches[k], j))) {
          sum += 1 - Compare(views, patches.patches[k], j).zncc;
        }
      }
    }
    return sum;
  }
};

// By all parameters of all poses, at cameras that are off.
TEST(WindowShift, SlopesByPosesAreTheEnergys) {
  const Windows windows;
  ASSERT_GT(windows.patches.patches.size(), 100u);
  const std::vector<View>& views = windows.cameras.views;
  std::vector<PoseStep> slopes(views.size(), PoseStep::Zero());
  for (size_t k = 0; k < windows.patches.patches.size(); ++k) {
    const SurfacePatch& patch = windows.patches.patches[k];
    const Vector3d point =
        PatchPoint(views[patch.view], windows.FrameOf(patch.facet), patch);
    for (const uint32_t j : windows.patches.partners[k]) {
      const WindowShift shift = windows.Compare(views, patch, j);
      if (windows.IsWhole(shift)) {
        const ShiftJacobian jacobian = ComputeShiftJacobian(
            views[patch.view], views[j], point, patch.normal);
        slopes[patch.view] += jacobian.by_pose_i.transpose() * shift.slope;
        slopes[j] += jacobian.by_pose_j.transpose() * shift.slope;
      }
    }
  }
  double product = 0;
  double analytic = 0;
  double numeric = 0;
  for (size_t i = 0; i < views.size(); ++i) {
    const double depth = views[i].cam_from_world_translation.norm();
    for (int k = 0; k < 6; ++k) {
      // So that all parameters count alike: px.
      const double unit = (k < 3 ? 1 : depth) / views[i].fx;
      const double step = 0.01 * unit;
      std::vector<View> plus = views;
      std::vector<View> minus = views;
      plus[i] =
          MoveView(views[i], step * PoseStep::Unit(k), IntrinsicsStep::Zero());
      minus[i] =
          MoveView(views[i], -step * PoseStep::Unit(k), IntrinsicsStep::Zero());
      const double slope =
          (windows.Energy(plus) - windows.Energy(minus)) / (2 * step) * unit;
      const double ours = slopes[i][k] * unit;
      product += slope * ours;
      analytic += ours * ours;
      numeric += slope * slope;
    }
  }
  EXPECT_GT(product / std::sqrt(analytic * numeric), 0.999);
  EXPECT_NEAR(std::sqrt(analytic / numeric), 1, 0.02);
  EXPECT_LT(windows.Energy(windows.scene.truth.views),
            0.7 * windows.Energy(windows.cameras.views));
}

TEST(SelectPatches, SpreadOverEachViewAndSeenByOthers) {
  const Windows windows;
  std::vector<size_t> counts(windows.cameras.views.size(), 0);
  for (size_t k = 0; k < windows.patches.patches.size(); ++k) {
    const SurfacePatch& patch = windows.patches.patches[k];
    ++counts[patch.view];
    EXPECT_FALSE(windows.patches.partners[k].empty());
    EXPECT_LE(windows.patches.partners[k].size(),
              static_cast<size_t>(windows.options.max_partners));
    for (const uint32_t j : windows.patches.partners[k]) {
      EXPECT_NE(j, patch.view);
    }
  }
  for (const size_t count : counts) {
    EXPECT_GT(count, 10u);
  }
}

View MakeView(const Vector3d& center, double focal) {
  View view{"", 640, 480, focal, 1.1 * focal, 310, 250};
  view.cam_from_world_rotation =
      (Eigen::AngleAxisd(0.1 * center.x(), Vector3d::UnitY()) *
       Eigen::AngleAxisd(0.2 * center.y(), Vector3d::UnitX()))
          .toRotationMatrix();
  view.cam_from_world_translation = -view.cam_from_world_rotation * center;
  return view;
}

// Where j shows the point of a plane that a pixel of i shows.
Vector2d Warp(const View& i, const View& j, const Vector2d& pixel,
              const Vector3d& on_plane, const Vector3d& normal) {
  const Vector3d ray = i.RayFromPixel() * Vector3d(pixel.x(), pixel.y(), 1);
  const Vector3d center = i.Center();
  return j.ImageFromCam(j.CamFromWorld(center + normal.dot(on_plane - center) /
                                                    normal.dot(ray) * ray));
}

struct ShiftJacobianTest : testing::Test {
  const View i_ = MakeView({-0.6, 0.1, -3}, 500);
  const View j_ = MakeView({0.7, -0.2, -3.3}, 600);
  const Vector3d point_{0.3, -0.2, 0.4};
  const Vector3d normal_ = Vector3d(0.3, 0.2, -0.9).normalized();
  const Vector2d pixel_ = i_.ImageFromCam(i_.CamFromWorld(point_));
  const ShiftJacobian jacobian_ = ComputeShiftJacobian(i_, j_, point_, normal_);

  // Central differences of a warp by its parameter.
  static Vector2d Differentiate(const std::function<Vector2d(double)>& warp) {
    constexpr double kStep = 1e-6;
    return (warp(kStep) - warp(-kStep)) / (2 * kStep);
  }

  // \param move  a view by a size along a parameter k.
  template <typename Jacobian, typename Move>
  void ExpectByEither(const Jacobian& by_i, const Jacobian& by_j,
                      const Move& move) const {
    for (int k = 0; k < by_i.cols(); ++k) {
      const Vector2d of_i = Differentiate([&](double size) {
        return Warp(move(i_, size, k), j_, pixel_, point_, normal_);
      });
      const Vector2d of_j = Differentiate([&](double size) {
        return Warp(i_, move(j_, size, k), pixel_, point_, normal_);
      });
      EXPECT_LT((of_i - by_i.col(k)).norm(), 1e-4) << k;
      EXPECT_LT((of_j - by_j.col(k)).norm(), 1e-4) << k;
    }
  }
};

TEST_F(ShiftJacobianTest, IsTheDerivativeByEitherPoseAndCamera) {
  ExpectByEither(jacobian_.by_pose_i, jacobian_.by_pose_j,
                 [](const View& view, double size, int k) {
                   return MoveView(view, size * PoseStep::Unit(k),
                                   IntrinsicsStep::Zero());
                 });
  ExpectByEither(jacobian_.by_intrinsics_i, jacobian_.by_intrinsics_j,
                 [](const View& view, double size, int k) {
                   return MoveView(view, PoseStep::Zero(),
                                   size * IntrinsicsStep::Unit(k));
                 });
}

TEST_F(ShiftJacobianTest, IsTheDerivativeByTheDisplacementAndThePixel) {
  const Vector2d by_displacement = Differentiate([&](double size) {
    return Warp(i_, j_, pixel_, point_ + size * normal_, normal_);
  });
  EXPECT_LT((by_displacement - jacobian_.by_displacement).norm(), 1e-4);
  for (int k = 0; k < 2; ++k) {
    const Vector2d by_pixel = Differentiate([&](double size) {
      return Warp(i_, j_, pixel_ + size * Vector2d::Unit(k), point_, normal_);
    });
    EXPECT_LT((by_pixel - jacobian_.by_pixel_i.col(k)).norm(), 1e-6);
  }
}

// A motion of all cameras together, which the world does not see, is the one
// that moves no pixel if the plane goes with it.
TEST_F(ShiftJacobianTest, MotionAlongTheRayIsTheDisplacements) {
  const Vector3d along = i_.cam_from_world_rotation * (point_ - i_.Center());
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

}  // namespace colmap_ext::window_shift_test
