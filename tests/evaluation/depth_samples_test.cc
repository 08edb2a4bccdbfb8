#include "evaluation/depth_samples.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "scene/look_at.h"

namespace colmap_ext {
namespace depth_samples_test {

// A tilted triangle in front of a camera.
TriangleMesh Triangle() {
  return {{{-1, -1, 0}, {1, -0.5f, 0.5f}, {0, 1, -0.3f}}, {{0, 1, 2}}};
}

View Camera() {
  return LookAtView({0.2, 0.1, 3}, {0, 0, 0}, {0, 1, 0}, 31, 22, 46.5);
}

TEST(RenderDepths, OfSomePixelsIsAPartOfAll) {
  const Bvh bvh(Triangle());
  const DepthMap all = RenderDepths(bvh, Camera(), 1);
  EXPECT_EQ(all.width, 31);
  EXPECT_EQ(all.height, 22);
  for (const int stride : {1, 2, 3, 5, 40}) {
    const DepthMap some = RenderDepths(bvh, Camera(), stride);
    const DepthMap part = Subsample(all, stride);
    EXPECT_EQ(some.width, part.width);
    EXPECT_EQ(some.height, part.height);
    ASSERT_EQ(some.depths.size(), part.depths.size());
    for (size_t i = 0; i < some.depths.size(); ++i) {
      EXPECT_FLOAT_EQ(some.depths[i], part.depths[i]);
    }
  }
}

TEST(PointsWhere, AreOnTheSurfaceAndInTheirPixels) {
  const TriangleMesh mesh = Triangle();
  const Bvh bvh(mesh);
  const View view = Camera();
  const DepthMap depths = RenderDepths(bvh, view, 3);
  const std::vector<Eigen::Vector3f> points = PointsWhere(depths, depths, view);
  EXPECT_GT(points.size(), 10);
  for (const Eigen::Vector3f& point : points) {
    EXPECT_LT(bvh.Distance(point, 1), 1e-6);
    const Eigen::Vector2d at =
        view.ImageFromCam(view.CamFromWorld(point.cast<double>()));
    for (const double x : at) {
      EXPECT_NEAR((x - 1.5) / 3, std::round((x - 1.5) / 3), 1e-4);
    }
  }
  const DepthMap nothing = RenderDepths(Bvh(TriangleMesh()), view, 3);
  EXPECT_TRUE(PointsWhere(depths, nothing, view).empty());
}

TEST(ResizeView, SeesTheSameThroughAnotherSize) {
  const View view = Camera();
  const View resized = ResizeView(view, 62, 11);
  const Eigen::Vector3d point(0.1, 0.2, 2);
  const Eigen::Vector2d at = view.ImageFromCam(point);
  EXPECT_TRUE(resized.ImageFromCam(point).isApprox(
      Eigen::Vector2d(2 * at.x(), at.y() / 2)));
}

TEST(AddDepthErrors, CountsPixelsByTheirErrors) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  DepthErrors errors;
  errors.thresholds = {0.25, 1};
  const DepthMap truth{7, 1, 1, {2, 2, 2, 2, 2, 0, kNan}};
  const DepthMap mesh{7, 1, 1, {2, 2.25f, 1.5f, 3.5f, 0, 2, 2}};
  AddDepthErrors(truth, mesh, &errors);
  EXPECT_EQ(errors.num_depths, 5);
  EXPECT_EQ(errors.num_missing, 1);
  EXPECT_DOUBLE_EQ(errors.Share(0), 0.2);
  EXPECT_DOUBLE_EQ(errors.Share(1), 0.6);
  AddDepthErrors(truth, truth, &errors);
  EXPECT_DOUBLE_EQ(errors.Share(0), 0.6);
  EXPECT_DOUBLE_EQ(errors.Share(1), 0.8);
}

}  // namespace depth_samples_test
}  // namespace colmap_ext
