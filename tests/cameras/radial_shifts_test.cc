// Errors of lenses that windows across the epipolar lines show.

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/cameras/camera_scene.h"
#include "tests/random.h"

namespace colmap_ext::radial_shifts_test {

// px, of a shift of the view's lens at a distance from its principal point.
double TrueShift(uint32_t camera, double share) {
  return camera == 0 ? 0.4 * std::sin(6 * share) : -0.3 * share * share;
}

Eigen::Vector2d LensShift(const View& view, uint32_t camera,
                          const Eigen::Vector2d& pixel) {
  const Eigen::Vector2d offset = pixel - Eigen::Vector2d(view.cx, view.cy);
  return TrueShift(camera, offset.norm() / HalfDiagonal(view)) *
         offset.normalized();
}

// Windows anywhere, whose shifts along the epipolar lines say nothing.
struct RandomShifts {
  explicit RandomShifts(double strength, double noise) {
    constexpr uint32_t kNumViews = 6;
    constexpr uint32_t kNumShifts = 6000;
    Random random(1);
    const auto pixel = [&] {
      return Eigen::Vector2d(640 * random.Unit(), 480 * random.Unit());
    };
    for (uint32_t i = 0; i < kNumViews; ++i) {
      View& view = views.emplace_back();
      view.width = 640;
      view.height = 480;
      view.cx = 320;
      view.cy = 240;
      view_cameras.push_back(i % 2);
    }
    for (uint32_t k = 0; k < kNumShifts; ++k) {
      ShiftMeasurement& shift = shifts.emplace_back();
      shift.patch = k;
      shift.i = k % kNumViews;
      shift.j = (k + 1 + k / kNumViews % (kNumViews - 1)) % kNumViews;
      const Eigen::Vector2d pixel_i = pixel();
      SurfacePatch& patch = patches.emplace_back();
      patch.row = static_cast<int>(pixel_i.y());
      patch.col = static_cast<int>(pixel_i.x());
      ShiftJacobian& jacobian = shift.jacobian;
      jacobian.pixel_j = pixel();
      jacobian.by_pixel_i =
          Eigen::Rotation2Dd(0.3).toRotationMatrix() * (0.8 + random.Unit());
      const double angle = 2 * M_PI * random.Unit();
      jacobian.by_displacement = {std::cos(angle), std::sin(angle)};
      const Eigen::Vector2d across(-std::sin(angle), std::cos(angle));
      shift.shift =
          strength * (LensShift(views[shift.j], shift.j % 2, jacobian.pixel_j) -
                      jacobian.by_pixel_i *
                          LensShift(views[shift.i], shift.i % 2,
                                    {patch.col + 0.5, patch.row + 0.5})) +
          5 * random.Unit() * jacobian.by_displacement +
          noise * (2 * random.Unit() - 1) * across;
      if (k % 50 == 0) {
        shift.shift = 3 * across;
      }
    }
  }

  std::vector<RadialShifts> Estimate() const {
    return EstimateRadialShifts(views, view_cameras, patches, shifts);
  }

  std::vector<View> views;
  std::vector<uint32_t> view_cameras;
  std::vector<SurfacePatch> patches;
  std::vector<ShiftMeasurement> shifts;
};

TEST(EstimateRadialShifts, FindsThoseOfEachCamera) {
  const RandomShifts random(1, 0.1);
  const std::vector<RadialShifts> estimated = random.Estimate();
  ASSERT_EQ(estimated.size(), random.views.size());
  for (size_t view = 0; view < estimated.size(); ++view) {
    EXPECT_EQ(estimated[view][0], 0);
    for (size_t k = 1; k < estimated[view].size() - 1; ++k) {
      EXPECT_NEAR(estimated[view][k] * HalfDiagonal(random.views[view]),
                  TrueShift(view % 2, k / 16.0), 0.03)
          << view << " " << k;
    }
  }
}

TEST(EstimateRadialShifts, FindsNoneInNoise) {
  EXPECT_TRUE(RandomShifts(0, 0.2).Estimate().empty());
  EXPECT_TRUE(EstimateRadialShifts({View()}, {0}, {}, {}).empty());
}

// Images through a lens match about as well when what is measured is corrected
// as when the lens itself is.
TEST(MeasureMisalignment, FindsTheLensOfImages) {
  const CameraScene scene = MakeCameraScene(false, 320);
  const std::vector<View>& views = scene.truth.views;
  const auto lens = [&](double pixels) {
    RadialShifts shifts{};
    for (size_t k = 0; k < shifts.size(); ++k) {
      shifts[k] = pixels * std::sin(0.4 * static_cast<double>(k)) /
                  HalfDiagonal(views[0]);
    }
    return std::vector<RadialShifts>(views.size(), shifts);
  };
  const std::shared_ptr<ImagePyramid> shifted = scene.scene.Pyramid();
  shifted->CorrectLenses(lens(-0.5));
  ImagePyramid images(
      views, [&](size_t view) { return *shifted->Image(view); }, SIZE_MAX);
  const SparseTracks no_tracks;  // the true ones know of no lens
  const PhotometricOptions photometric;
  const VisibilityBuffers buffers(scene.scene.Truth(), views,
                                  photometric.min_cosine, SIZE_MAX);
  CameraRefinementOptions options;
  options.parts = RefinedParts::kPoses;
  const CameraInput input{photometric, no_tracks, buffers, scene.pairs,
                          &images};
  const std::vector<RadialShifts> measured =
      MeasureMisalignment(options, input, scene.truth).radial_shifts;
  const auto zncc = [&](const std::vector<RadialShifts>& shifts) {
    images.CorrectLenses(shifts);
    return RefineCameras(options, input, scene.truth, scene.truth)
        .report.mean_zncc;
  };
  const double by_lens = zncc({});
  EXPECT_GT(zncc(measured), by_lens + 0.7 * (zncc(lens(0.5)) - by_lens));
}

}  // namespace colmap_ext::radial_shifts_test
