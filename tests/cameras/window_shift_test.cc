#include "cameras/surface_patches.h"

#include <cmath>

#include <gtest/gtest.h>

#include "cameras/camera_set.h"
#include "raster/facet_frames.h"
#include "tests/cameras/camera_scene.h"

namespace colmap_ext {
namespace window_shift_test {

// A scene, its cameras a little off, and windows of it.
struct Windows {
  CameraScene scene = MakeCameraScene(false, 320);
  CameraSet cameras = Disturb(scene, scene.truth, 0.3, 1);
  PhotometricOptions photometric;
  PatchOptions options{.radius = 5, .max_patches_per_view = 50};
  std::shared_ptr<ImagePyramid> images = scene.scene.Pyramid();
  VisibilityBuffers buffers{scene.scene.Truth(), cameras.views,
                            photometric.min_cosine, SIZE_MAX};
  std::vector<FacetFrame> frames = ComputeFacetFrames(scene.scene.Truth());
  SurfacePatches patches = SelectPatches(
      options, photometric, {buffers, frames, images.get()}, scene.pairs);

  WindowShift Compare(const std::vector<View>& views, const SurfacePatch& patch,
                      uint32_t j) const {
    const auto image_i = images->Image(patch.view);
    const auto image_j = images->Image(j);
    const auto drawn_i = buffers.Get(patch.view);
    const auto drawn_j = buffers.Get(j);
    return CompareWindow(photometric, options.radius,
                         {views[patch.view], *image_i, *drawn_i},
                         {views[j], *image_j, *drawn_j}, frames, patch);
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
    const Eigen::Vector3d point =
        PatchPoint(views[patch.view], windows.frames[patch.facet], patch);
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
}

TEST(WindowShift, IsLeastWhereTheCamerasAreRight) {
  const Windows windows;
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

}  // namespace window_shift_test
}  // namespace colmap_ext
