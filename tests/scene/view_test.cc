#include "scene/view.h"

#include <cmath>

#include <gtest/gtest.h>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "scene/half_pixel.h"
#include "scene/images.h"
#include "tests/random_vectors.h"

namespace colmap_ext::view_test {

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

TEST(View, ImagesScaleWithTheFocalLengths) {
  const View view{"", 0, 0, 500, 600, 480, 410};
  const Vector2d pixel = view.ImageFromCam({0.2, -0.1, 2});
  EXPECT_DOUBLE_EQ(pixel.x(), 500 * 0.1 + 480);
  EXPECT_DOUBLE_EQ(pixel.y(), 600 * -0.05 + 410);
}

TEST(View, RaysGoFromTheCenterThroughWhatIsSeenThereAndBack) {
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
    EXPECT_LT(
        ((view.PixelFromRay() * (point - view.Center())).hnormalized() - pixel)
            .norm(),
        1e-9);
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
    const View same = ResizeView(view, view.width, view.height);
    EXPECT_EQ(same.width, view.width);
    EXPECT_EQ(same.height, view.height);
    EXPECT_EQ(same.PixelFromRay(), view.PixelFromRay());
  }
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
      Vector2d(0.5 * view.width, 0.5 * view.height), 1e-9));
}

TEST(LookAtView, HasTheTargetInItsMiddleAndUpUpwardsIfNotAhead) {
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
  for (const double length : {0.0, 1.0, -5.0}) {
    ExpectLooksAt(
        LookAtView({1, 2, 3}, {1, 2, 7}, {0, 0, length}, 320, 240, 500),
        {1, 2, 3}, {1, 2, 7});
  }
}

View MakeView(double fx, double fy) {
  return {"", 1000, 800, fx, fy, 480, 410};
}

void AddPoint(const Eigen::Vector3f& position,
              const std::vector<uint32_t>& views, PointCloud* cloud) {
  cloud->positions.push_back(position);
  cloud->views.AddRow(views);
}

TEST(HalfPixelOffsets, AreTheMeanOverTheViews) {
  PointCloud cloud;
  AddPoint({0, 0, 4}, {0, 1}, &cloud);
  AddPoint({0, 0, 4}, {1}, &cloud);
  AddPoint({0, 0, 4}, {}, &cloud);
  AddPoint({1, 2, 4}, {0}, &cloud);
  std::vector<View> views = {MakeView(100, 200), MakeView(50, 50)};
  // From the right: its right is the world's z, its down the world's y.
  views[1].cam_from_world_rotation << 0, 0, 1, 0, 1, 0, -1, 0, 0;
  views[1].cam_from_world_translation = {0, 0, 10};
  const auto offsets = HalfPixelOffsets(cloud, views);
  ASSERT_EQ(offsets.size(), 4u);
  EXPECT_TRUE(offsets[1].isApprox(Eigen::Vector3f(0, 0.1f, 0.1f)));
  EXPECT_TRUE(offsets[0].isApprox(Eigen::Vector3f(0.01f, 0.055f, 0.05f)));
  EXPECT_TRUE(offsets[2].isZero());
  // 4 / 100 and 4 / 200 are a pixel's width and height there.
  EXPECT_TRUE(offsets[3].isApprox(Eigen::Vector3f(0.02f, 0.01f, 0)));
  // Depth maps of half the size have pixels of twice the size.
  EXPECT_TRUE(HalfPixelOffsets(cloud, views, {0.5, 1})[3].isApprox(
      Eigen::Vector3f(0.04f, 0.02f, 0)));
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
    const Vector3d point = cloud.positions[0].cast<double>();
    const Vector3d moved =
        point + HalfPixelOffsets(cloud, {view})[0].cast<double>();
    const Vector2d shift = Project(view, moved) - Project(view, point);
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
      View view{"", 1000, 1000, 300, 300, 500, 500};
      view.cam_from_world_rotation =
          Eigen::AngleAxisd(i * M_PI / 3, Vector3d(0.1, 1, 0).normalized())
              .toRotationMatrix();
      view.cam_from_world_translation = {0, 0, 4};
      views.push_back(view);
    }
    for (int i = 0; i < 40000; ++i) {
      const Vector3d normal = RandomNormal(&random);
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
      const Vector3d normal = RandomNormal(&random);
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

TEST(RegressHalfPixel, IsNotMovedByOutliersNorByWhatWasNotFused) {
  Sphere sphere;
  Random random(3);
  for (size_t i = 0; i < sphere.sparse_points.size(); i += 10) {
    sphere.sparse_points[i] *= static_cast<float>(0.5 + random.Unit());
  }
  EXPECT_NEAR(sphere.Regress(1).slope, 1, 0.1);
  // Sparse points of what was masked out of the fusion.
  sphere = Sphere();
  for (int i = 0; i < 6000; ++i) {
    sphere.sparse_points.emplace_back(4 * random.Unit() - 2, -1.2F,
                                      4 * random.Unit() - 2);
  }
  const HalfPixelSlope result = sphere.Regress(1);
  EXPECT_GT(result.num_points, 1000u);
  EXPECT_NEAR(result.slope, 1, 0.05);
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

}  // namespace colmap_ext::view_test
