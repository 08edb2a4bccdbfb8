#include "meshing/ray_ends.h"

#include <algorithm>
#include <limits>

#include <gtest/gtest.h>

#include "scene/view.h"
#include "tests/random_vectors.h"

namespace colmap_ext::ray_ends_test {

View FrontView(double x) {
  return LookAtView({x, 0, -10}, {0, 0, 0}, {0, 1, 0}, 640, 480, 600);
}

// Points in a cube of sides of 8 around the origin, seen by both views.
PointCloud RandomCloud() {
  Random random(5);
  PointCloud cloud;
  for (int i = 0; i < 2000; ++i) {
    cloud.positions.push_back(RandomVector(&random, 4).cast<float>());
    cloud.colors.push_back({1, 2, static_cast<uint8_t>(i)});
    cloud.views.AddRow(std::vector<uint32_t>{0, 1});
  }
  return cloud;
}

struct CropCloudTest : testing::Test {
  CropCloudTest() {
    weighted_ = {cloud_, std::vector<float>(2000, 0.5f), 2000};
    ends_ = CropCloud(region_, views_, &weighted_);
  }

  const Region region_ = RegionBetween({-1, -1, -1}, {1, 1, 1});
  const Region grown_ = Grow(region_, MarginOf(region_));
  const std::vector<View> views_ = {FrontView(-2), FrontView(2)};
  const PointCloud cloud_ = RandomCloud();
  WeightedCloud weighted_;
  RayEnds ends_;
};

TEST_F(CropCloudTest, KeepsThePointsOfTheRegionAndItsMarginAndWeights) {
  const auto num_inside = static_cast<size_t>(std::ranges::count_if(
      cloud_.positions,
      [&](const auto& position) { return grown_.Contains(position); }));
  EXPECT_EQ(weighted_.cloud.size(), num_inside);
  EXPECT_EQ(weighted_.cloud.colors.size(), num_inside);
  EXPECT_EQ(weighted_.cloud.views.size(), num_inside);
  for (const Eigen::Vector3f& position : weighted_.cloud.positions) {
    EXPECT_TRUE(grown_.Contains(position));
  }
  // The rays that are merged keep their weight: that of all points behind the
  // region, once for each view.
  double expected = 0;
  for (const Eigen::Vector3f& position : cloud_.positions) {
    for (const View& view : views_) {
      const bool is_behind =
          !PartInside(region_, view.Center(), position.cast<double>())
               .IsEmpty();
      expected += grown_.Contains(position) || !is_behind ? 0 : 0.5;
    }
  }
  double sum = 0;
  for (const RayEnd& end : ends_) {
    sum += end.weight;
  }
  EXPECT_NEAR(sum, expected, 1e-3);
}

// Each end lies on the border of the margin, on the far side as its view sees
// it, and the ray to it passes through the region.
TEST_F(CropCloudTest, RaysEndWhereTheyLeave) {
  ASSERT_GT(ends_.size(), 20u);
  for (const auto& [position, view, weight] : ends_) {
    const Eigen::Vector3d end = position.cast<double>();
    const Eigen::Vector3d center = views_[view].Center();
    EXPECT_NEAR(
        (grown_.FromCenter(end).cwiseAbs() - grown_.half_sizes).maxCoeff(), 0,
        1e-5);
    EXPECT_NEAR(PartInside(grown_, center, center + 2 * (end - center)).second,
                0.5, 1e-5);
    EXPECT_FALSE(PartInside(region_, center, end).IsEmpty());
  }
}

TEST_F(CropCloudTest, AppendsEndsBehindThePoints) {
  const PointCloud& joined = weighted_.cloud;
  const size_t num_points = joined.size();
  AppendEnds(ends_, &weighted_);
  EXPECT_EQ(weighted_.num_points, num_points);
  ASSERT_EQ(joined.size(), num_points + ends_.size());
  EXPECT_EQ(joined.colors.size(), joined.size());
  ASSERT_EQ(weighted_.weights.size(), joined.size());
  for (size_t i = 0; i < ends_.size(); ++i) {
    const size_t place = num_points + i;
    EXPECT_EQ(joined.positions[place], ends_[i].position);
    EXPECT_EQ(weighted_.weights[place], ends_[i].weight);
    ASSERT_EQ(joined.views[place].size(), 1u);
    EXPECT_EQ(joined.views[place][0], ends_[i].view);
  }
}

// A point that is thinned out in favour of an end, or the other way around,
// votes for nothing.
TEST(MarkEndsTest, SilencesWhatWasThinnedAcross) {
  ThinnedPoints thinned;
  thinned.vertex_points = {0, 2};         // the third is an end
  thinned.point_vertices = {0, 1, 1, 0};  // of two points and two ends
  WeightedCloud weighted;
  weighted.cloud.positions.resize(4);
  weighted.weights = {1, 1, 1, 1};
  weighted.num_points = 2;
  EXPECT_EQ(MarkEnds(thinned, &weighted), (std::vector<uint8_t>{0, 1}));
  EXPECT_EQ(weighted.weights, (std::vector<float>{1, 0, 1, 0}));
  weighted.num_points = 4;
  EXPECT_TRUE(MarkEnds(thinned, &weighted).empty());
}

TEST(BackgroundEnds, AreWhereRaysOfMaskedPixelsLeave) {
  const View view = FrontView(1);
  const Region region = RegionBetween({-1, -1, -1}, {1, 1, 1});
  GrayImage mask{view.width, view.height, {}};
  for (int i = 0; i < view.width * view.height; ++i) {
    mask.pixels.push_back(i % view.width < view.width / 2 ? 0 : 255);
  }
  const RayEnds ends = BackgroundEnds(region, view, 3, mask);
  ASSERT_GT(ends.size(), 20u);
  for (const auto& [position, from_view, weight] : ends) {
    EXPECT_EQ(from_view, 3u);
    const Eigen::Vector3d end = position.cast<double>();
    EXPECT_LT(view.ImageFromCam(view.CamFromWorld(end)).x(),
              view.width / 2 - 2);
    EXPECT_NEAR(end.cwiseAbs().maxCoeff(), 1, 1e-5);
    EXPECT_GT(PartInside(region, view.Center(),
                         view.Center() + 2 * (end - view.Center()))
                  .second,
              0.49);
  }
  mask.pixels.assign(mask.pixels.size(), 255);
  EXPECT_EQ(BackgroundEnds(region, view, 0, mask).size(), 0u);
  EXPECT_EQ(BackgroundEnds(region, view, 0, GrayImage()).size(), 0u);
}

TEST(DepthRayEnds, LieFourPixelsBeforeTheDepths) {
  const View view = FrontView(1);
  DepthMap depths{view.width / 2, view.height / 2, 1, {}};
  depths.depths.assign(320 * 240, 10);
  const std::vector<Eigen::Vector3f> ends = DepthRayEnds(view, depths);
  ASSERT_EQ(ends.size(), 320u / kDepthSpacing * 240 / kDepthSpacing);
  for (size_t i = 0; i < ends.size(); ++i) {
    const Eigen::Vector3d end = view.CamFromWorld(ends[i].cast<double>());
    EXPECT_NEAR(end.z(), 10 * (1 - 4 / (0.5 * view.fx)), 1e-5);
    const size_t row = i / (320 / kDepthSpacing);
    const size_t col = i % (320 / kDepthSpacing);
    const Eigen::Vector2d pixel(col * kDepthSpacing + kDepthSpacing / 2 + 0.5,
                                row * kDepthSpacing + kDepthSpacing / 2 + 0.5);
    EXPECT_LT((view.ImageFromCam(end) - 2 * pixel).norm(), 1e-3);
  }
}

TEST(DepthRayEnds, AreNotThereWithoutADepth) {
  const View view = FrontView(1);
  DepthMap depths{view.width, view.height, 1, {}};
  for (const float depth : {0.0f, -1.0f, std::numeric_limits<float>::infinity(),
                            std::numeric_limits<float>::quiet_NaN(), 1e30f}) {
    depths.depths.assign(640 * 480, depth);
    EXPECT_TRUE(DepthRayEnds(view, depths).empty()) << depth;
  }
  EXPECT_TRUE(DepthRayEnds(view, DepthMap()).empty());
}

TEST(RegionOfCloudTest, HoldsAllPoints) {
  const PointCloud cloud = RandomCloud();
  const Region region = RegionOfCloud(cloud);
  for (const Eigen::Vector3f& position : cloud.positions) {
    EXPECT_TRUE(region.Contains(position));
  }
  EXPECT_NEAR(region.half_sizes.x(), 4.8, 0.02);
}

}  // namespace colmap_ext::ray_ends_test
