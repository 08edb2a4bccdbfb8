#include "refine/point_confidences.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <Eigen/Geometry>

#include "tests/look_at.h"
#include "tests/mesh/known_meshes.h"
#include "tests/random.h"

namespace colmap_ext {
namespace point_confidences_test {

// A sheet of 20 x 20 unit quads in z = 0 that two views look down on from
// above, and points on its left half.
class PointConfidencesTest : public testing::Test {
 protected:
  PointConfidencesTest() : mesh_(MakeSheet(kSide, kSide)) {
    for (uint32_t i = 0; i < mesh_.vertices.size(); ++i) {
      mesh_.vertices[i] = {static_cast<float>(i % (kSide + 1)),
                           static_cast<float>(i / (kSide + 1)), 0};
      vertex_views_.AddRow(std::vector<uint32_t>{0, 1});
    }
    const Facet& facet = mesh_.facets[0];
    const float z =
        (mesh_.vertices[facet[1]] - mesh_.vertices[facet[0]])
            .cross(mesh_.vertices[facet[2]] - mesh_.vertices[facet[0]])
            .z();
    up_ = z > 0 ? 1 : -1;
    for (const double x : {8.0, 12.0}) {
      views_.push_back(LookAtView({x, 10, 30.0 * up_}, {10, 10, 0},
                                  Eigen::Vector3d::UnitY(), 1000, 1000, 800));
    }
    AddPoints(0, 10, 0);
  }

  // Four a facet, at that height.
  void AddPoints(double from, double to, double height) {
    for (int i = 0; i < 8 * kSide * (to - from); ++i) {
      points_.positions.emplace_back(from + (to - from) * random_.Unit(),
                                     kSide * random_.Unit(), height);
      points_.views.AddRow(std::vector<uint32_t>{0, 1});
    }
  }

  std::vector<float> Confidences() const {
    return PointConfidences(mesh_, vertex_views_, points_, views_);
  }

  static constexpr uint32_t kSide = 20;
  TriangleMesh mesh_;
  Rows<uint32_t> vertex_views_;
  PointCloud points_;
  std::vector<View> views_;
  Random random_{1};
  double up_ = 1;
};

TEST_F(PointConfidencesTest, IsHighWherePointsAreAndZeroWhereNoneAre) {
  const std::vector<float> confidences = Confidences();
  for (size_t i = 0; i < confidences.size(); ++i) {
    if (mesh_.vertices[i].x() < 9) {
      EXPECT_GT(confidences[i], 0.4) << mesh_.vertices[i].transpose();
    } else if (mesh_.vertices[i].x() > 12) {
      EXPECT_EQ(confidences[i], 0) << mesh_.vertices[i].transpose();
    }
    EXPECT_LE(confidences[i], 1);
  }
}

// A pixel is 1/27 wide there.
TEST_F(PointConfidencesTest, PointsFarFromTheSurfaceDoNotCount) {
  const std::vector<float> before = Confidences();
  AddPoints(12, 20, 0.5);
  EXPECT_EQ(Confidences(), before);
  AddPoints(12, 20, 0.05);
  EXPECT_GT(Confidences().back(), 0.3);
}

TEST_F(PointConfidencesTest, PointsOfTheOtherSideDoNotCount) {
  for (Facet& facet : mesh_.facets) {
    std::swap(facet[1], facet[2]);
  }
  for (const float confidence : Confidences()) {
    EXPECT_EQ(confidence, 0);
  }
}

TEST_F(PointConfidencesTest, IsZeroWithoutPoints) {
  points_ = {};
  EXPECT_EQ(Confidences(), std::vector<float>(mesh_.vertices.size(), 0));
}

TEST_F(PointConfidencesTest, IsTheSameAtAnyNumberOfThreads) {
  const std::vector<float> confidences = Confidences();
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism,
                                1);
  EXPECT_EQ(Confidences(), confidences);
}

}  // namespace point_confidences_test
}  // namespace colmap_ext
