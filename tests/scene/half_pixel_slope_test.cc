
#include <cmath>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "scene/half_pixel.h"
#include "tests/random.h"

namespace colmap_ext {
namespace half_pixel_slope_test {

void AddPoint(const Eigen::Vector3f& position,
              const std::vector<uint32_t>& views, PointCloud* cloud) {
  cloud->positions.push_back(position);
  cloud->views.AddRow(views);
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
      const Eigen::Vector3d normal = Normal(&random);
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
    for (int i = 0; i < 2000; ++i) {
      const double noise = 0.002 * (2 * random.Unit() - 1);
      const Eigen::Vector3d normal = Normal(&random);
      if (std::abs(normal.y()) < 0.8) {  // where the views see it
        sparse_points.push_back(((1 + noise) * normal).cast<float>());
      }
    }
  }

  static Eigen::Vector3d Normal(Random* random) {
    const double z = 2 * random->Unit() - 1;
    const double angle = 2 * M_PI * random->Unit();
    const double r = std::sqrt(1 - z * z);
    return {r * std::cos(angle), r * std::sin(angle), z};
  }

  // The cloud with a share of the error.
  PointCloud OffBy(float share) const {
    const auto offsets = HalfPixelOffsets(cloud, views);
    PointCloud off = cloud;
    for (size_t i = 0; i < off.size(); ++i) {
      off.positions[i] -= share * offsets[i];
    }
    return off;
  }

  PointCloud cloud;
  std::vector<View> views;
  std::vector<Eigen::Vector3f> sparse_points;
};

TEST(RegressHalfPixel, SlopeIsTheShareOfTheOffsetThatIsThere) {
  const Sphere sphere;
  const auto offsets = HalfPixelOffsets(sphere.cloud, sphere.views);
  for (const float share : {0.0f, 0.5f, 1.0f}) {
    const HalfPixelSlope result =
        RegressHalfPixel(sphere.OffBy(share), offsets, sphere.sparse_points);
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
  const auto offsets = HalfPixelOffsets(sphere.cloud, sphere.views);
  Random random(3);
  for (size_t i = 0; i < sphere.sparse_points.size(); i += 10) {
    sphere.sparse_points[i] *= static_cast<float>(0.5 + random.Unit());
  }
  const HalfPixelSlope result =
      RegressHalfPixel(sphere.OffBy(1), offsets, sphere.sparse_points);
  EXPECT_NEAR(result.slope, 1, 0.1);
}

TEST(RegressHalfPixel, LeavesOutSparsePointsBeyondAllDistances) {
  Sphere sphere;
  const auto offsets = HalfPixelOffsets(sphere.cloud, sphere.views);
  const PointCloud cloud = sphere.OffBy(1);
  const HalfPixelSlope expected =
      RegressHalfPixel(cloud, offsets, sphere.sparse_points);
  sphere.sparse_points.emplace_back(1e30f, 0, 0);
  sphere.sparse_points.emplace_back(std::nanf(""), 0, 0);
  const HalfPixelSlope result =
      RegressHalfPixel(cloud, offsets, sphere.sparse_points);
  EXPECT_EQ(result.num_points, expected.num_points);
  EXPECT_EQ(result.slope, expected.slope);
}

// Sparse points of what was masked out of the fusion.
TEST(RegressHalfPixel, IsNotMovedByWhatWasNotFused) {
  Sphere sphere;
  const auto offsets = HalfPixelOffsets(sphere.cloud, sphere.views);
  Random random(4);
  for (int i = 0; i < 6000; ++i) {
    sphere.sparse_points.emplace_back(4 * random.Unit() - 2, -1.2F,
                                      4 * random.Unit() - 2);
  }
  const HalfPixelSlope result =
      RegressHalfPixel(sphere.OffBy(1), offsets, sphere.sparse_points);
  EXPECT_GT(result.num_points, 1000u);
  EXPECT_NEAR(result.slope, 1, 0.05);
}

TEST(RegressHalfPixel, SaysNothingOfTooFewPoints) {
  const Sphere sphere;
  const auto offsets = HalfPixelOffsets(sphere.cloud, sphere.views);
  const std::vector<Eigen::Vector3f> few(sphere.sparse_points.begin(),
                                         sphere.sparse_points.begin() + 10);
  EXPECT_EQ(RegressHalfPixel(sphere.cloud, offsets, few).num_points, 0u);
  EXPECT_EQ(RegressHalfPixel(sphere.cloud, offsets, {}).num_points, 0u);
  EXPECT_EQ(RegressHalfPixel(PointCloud(), {}, sphere.sparse_points).num_points,
            0u);
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

}  // namespace half_pixel_slope_test
}  // namespace colmap_ext
