#include "scene/half_pixel.h"

#include <cmath>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "tests/random_vectors.h"

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
        Eigen::AngleAxisd(6 * random.Unit(), RandomNormal(&random))
            .toRotationMatrix();
    view.cam_from_world_translation = {0, 0, 5};
    PointCloud cloud;
    AddPoint(RandomVector(&random).cast<float>(), {0}, &cloud);
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

// A sphere that six views around it see, as fused points and as sparse points.
struct Sphere {
  Sphere() {
    Random random(2);
    for (int i = 0; i < 6; ++i) {
      View view;
      view.width = view.height = 1000;
      view.fx = view.fy = 300;
      view.cx = view.cy = 500;
      view.cam_from_world_rotation =
          Eigen::AngleAxisd(i * M_PI / 3,
                            Eigen::Vector3d(0.1, 1, 0).normalized())
              .toRotationMatrix();
      view.cam_from_world_translation = {0, 0, 4};
      views.push_back(view);
    }
    for (int i = 0; i < 40000; ++i) {
      const Eigen::Vector3d normal = RandomNormal(&random);
      std::vector<uint32_t> seen_by;
      for (uint32_t view = 0; view < views.size(); ++view) {
        if ((views[view].Center() - normal).normalized().dot(normal) > 0.4) {
          seen_by.push_back(view);
        }
      }
      if (!seen_by.empty()) {
        AddPoint(normal.cast<float>(), seen_by, &cloud);
      }
    }
    offsets = HalfPixelOffsets(cloud, views);
    for (int i = 0; i < 2000; ++i) {
      const double noise = 0.002 * (2 * random.Unit() - 1);
      const Eigen::Vector3d normal = RandomNormal(&random);
      if (std::abs(normal.y()) < 0.8) {  // where the views see it
        sparse_points.push_back(((1 + noise) * normal).cast<float>());
      }
    }
  }

  // Of the cloud with a share of the error.
  HalfPixelSlope Regress(float share) const {
    PointCloud off = cloud;
    for (size_t i = 0; i < off.size(); ++i) {
      off.positions[i] -= share * offsets[i];
    }
    return RegressHalfPixel(off, offsets, sparse_points);
  }

  PointCloud cloud;
  std::vector<View> views;
  std::vector<Eigen::Vector3f> offsets;
  std::vector<Eigen::Vector3f> sparse_points;
};

TEST(RegressHalfPixel, SlopeIsTheShareOfTheOffsetThatIsThere) {
  const Sphere sphere;
  for (const float share : {0.0f, 0.5f, 1.0f}) {
    const HalfPixelSlope result = sphere.Regress(share);
    EXPECT_GT(result.num_points, 1000u);
    EXPECT_NEAR(result.slope, share, 0.05);
    EXPECT_GT(result.standard_error, 0);
    EXPECT_LT(result.standard_error, 0.05);
    // An honest error bar.
    EXPECT_LT(std::abs(result.slope - share), 5 * result.standard_error);
  }
}

TEST(RegressHalfPixel, IsNotMovedByOutliers) {
  Sphere sphere;
  Random random(3);
  for (size_t i = 0; i < sphere.sparse_points.size(); i += 10) {
    sphere.sparse_points[i] *= static_cast<float>(0.5 + random.Unit());
  }
  EXPECT_NEAR(sphere.Regress(1).slope, 1, 0.1);
}

TEST(RegressHalfPixel, LeavesOutSparsePointsBeyondAllDistances) {
  Sphere sphere;
  const HalfPixelSlope expected = sphere.Regress(1);
  sphere.sparse_points.emplace_back(1e30f, 0, 0);
  sphere.sparse_points.emplace_back(std::nanf(""), 0, 0);
  const HalfPixelSlope result = sphere.Regress(1);
  EXPECT_EQ(result.num_points, expected.num_points);
  EXPECT_EQ(result.slope, expected.slope);
}

// Sparse points of what was masked out of the fusion.
TEST(RegressHalfPixel, IsNotMovedByWhatWasNotFused) {
  Sphere sphere;
  Random random(4);
  for (int i = 0; i < 6000; ++i) {
    sphere.sparse_points.emplace_back(4 * random.Unit() - 2, -1.2F,
                                      4 * random.Unit() - 2);
  }
  const HalfPixelSlope result = sphere.Regress(1);
  EXPECT_GT(result.num_points, 1000u);
  EXPECT_NEAR(result.slope, 1, 0.05);
}

TEST(RegressHalfPixel, SaysNothingOfTooFewPoints) {
  const Sphere sphere;
  const std::vector<Eigen::Vector3f> few(sphere.sparse_points.begin(),
                                         sphere.sparse_points.begin() + 10);
  EXPECT_EQ(RegressHalfPixel(sphere.cloud, sphere.offsets, few).num_points, 0u);
  EXPECT_EQ(RegressHalfPixel(sphere.cloud, sphere.offsets, {}).num_points, 0u);
  EXPECT_EQ(RegressHalfPixel({}, {}, sphere.sparse_points).num_points, 0u);
}

TEST(CalibratedScale, LiesBetweenTheSlopeAndTheNominalOne) {
  EXPECT_EQ(CalibratedScale({}), 1);
  EXPECT_NEAR(CalibratedScale({5, 1e3, 100}), 1, 1e-4);  // says nothing
  EXPECT_DOUBLE_EQ(CalibratedScale({1, 0.01, 100}), 1);
  for (const double slope : {-0.2, 0.0, 0.5, 2.0}) {
    double last = slope;
    for (const double error : {1e-3, 0.1, 0.5, 2.0}) {
      const double scale = CalibratedScale({slope, error, 100});
      // The less certain, the nearer to the nominal one.
      EXPECT_LT(std::abs(scale - 1), std::abs(last - 1));
      EXPECT_GT((scale - 1) * (slope - 1), 0);
      last = scale;
    }
    EXPECT_NEAR(CalibratedScale({slope, 1e-3, 100}), slope, 0.1);
  }
}

}  // namespace half_pixel_test
}  // namespace colmap_ext
