#include "mesh/confidences.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "scene/look_at.h"
#include "tests/mesh/known_meshes.h"
#include "tests/random.h"
#include "tests/threads.h"

namespace colmap_ext {
namespace confidences_test {

// A square grid of unit facets that three views look down on.
class FacetConfidencesTest : public testing::Test {
 protected:
  static constexpr uint32_t kSide = 12;  // vertices

  FacetConfidencesTest() {
    for (uint32_t i = 0; i < kSide * kSide; ++i) {
      mesh_.vertices.emplace_back(static_cast<float>(i % kSide),
                                  static_cast<float>(i / kSide), 0.0f);
      vertex_views_.AddRow(std::vector<uint32_t>{0, 1, 2});
    }
    for (uint32_t i = 0; i + kSide < kSide * kSide; ++i) {
      if (i % kSide + 1 < kSide) {
        mesh_.facets.push_back({i, i + 1, i + kSide});
        mesh_.facets.push_back({i + 1, i + kSide + 1, i + kSide});
      }
    }
    for (const double x : {0.0, 5.0, 10.0}) {
      views_.push_back(LookAtView({x, 0, 30}, {6, 6, 0},
                                  Eigen::Vector3d::UnitY(), 1000, 1000, 1000));
    }
    support_.assign(kSide * kSide, 5.0f);
  }

  // A facet from the corner of the grid to two new vertices far away, each with
  // as much support as the others.
  void AddMembrane() {
    const auto first = static_cast<uint32_t>(mesh_.vertices.size());
    mesh_.vertices.emplace_back(-20.0f, 0.0f, -1.0f);
    mesh_.vertices.emplace_back(0.0f, -20.0f, -1.0f);
    mesh_.facets.push_back({0, first, first + 1});
    for (int i = 0; i < 2; ++i) {
      vertex_views_.AddRow(std::vector<uint32_t>{0, 1, 2});
      support_.push_back(5);
    }
  }

  std::vector<float> Confidences() const {
    return FacetConfidences(mesh_, support_, vertex_views_, views_);
  }

  TriangleMesh mesh_;
  std::vector<float> support_;
  Rows<uint32_t> vertex_views_;
  std::vector<View> views_;
};

void ExpectNear(const std::vector<float>& a, const std::vector<float>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (size_t i = 0; i < a.size(); ++i) {
    EXPECT_NEAR(a[i], b[i], 1e-5) << i;
  }
}

TEST_F(FacetConfidencesTest, IsSureOfWhatIsSeenAndNotOfAMembrane) {
  AddMembrane();
  std::vector<float> confidences = Confidences();
  EXPECT_LT(confidences.back(), 0.05);
  confidences.pop_back();
  for (const float confidence : confidences) {
    EXPECT_GT(confidence, 0.85);
    EXPECT_LE(confidence, 1);
  }
}

TEST_F(FacetConfidencesTest, AMembraneDoesNotChangeTheFacetsBesideIt) {
  const std::vector<float> before = Confidences();
  AddMembrane();
  std::vector<float> after = Confidences();
  after.pop_back();
  for (size_t i = 0; i < before.size(); ++i) {
    EXPECT_NEAR(before[i], after[i], 0.02) << i;
  }
}

TEST_F(FacetConfidencesTest, DependsOnNoScale) {
  Random random(1);
  for (float& support : support_) {
    support = static_cast<float>(1 + 10 * random.Unit());
  }
  const std::vector<float> confidences = Confidences();
  for (Eigen::Vector3f& vertex : mesh_.vertices) {
    vertex *= 4;
  }
  for (View& view : views_) {
    view.cam_from_world_translation *= 4;
  }
  ExpectNear(Confidences(), confidences);
  for (View& view : views_) {
    view = ResizeView(view, 500, 500);
  }
  ExpectNear(Confidences(), confidences);
  for (float& support : support_) {
    support *= 0.125f;
  }
  ExpectNear(Confidences(), confidences);
}

TEST_F(FacetConfidencesTest, MoreSupportIsNeverLessConfidence) {
  const float before = Confidences()[0];
  for (const uint32_t vertex : mesh_.facets[0]) {
    support_[vertex] /= 4;
  }
  EXPECT_LT(Confidences()[0], before);
}

TEST_F(FacetConfidencesTest, WhatNoViewOrPointBearsOutIsUnknown) {
  for (const uint32_t vertex : mesh_.facets[0]) {
    support_[vertex] = 0;
  }
  EXPECT_EQ(Confidences()[0], 0);
  EXPECT_GT(Confidences().back(), 0.5);
  std::fill(support_.begin(), support_.end(), 0.0f);
  EXPECT_EQ(Confidences(), std::vector<float>(mesh_.facets.size(), 0));
  std::fill(support_.begin(), support_.end(), 1.0f);
  vertex_views_ = Rows<uint32_t>(mesh_.vertices.size());
  EXPECT_EQ(Confidences(), std::vector<float>(mesh_.facets.size(), 0));
}

TEST_F(FacetConfidencesTest, IsTheSameAtAnyNumberOfThreads) {
  AddMembrane();
  ExpectSameForAnyThreads([&] { return Confidences(); });
}

TEST(VertexConfidences, WeighsFacetsByTheirAngles) {
  // A right angle and half of one at vertex 0.
  const TriangleMesh mesh = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 1, 0}},
                             {{0, 1, 2}, {0, 2, 3}}};
  const std::vector<float> confidences = VertexConfidences(mesh, {0.9f, 0.3f});
  EXPECT_NEAR(confidences[0], (2 * 0.9 + 0.3) / 3, 1e-6);
  EXPECT_NEAR(confidences[1], 0.9, 1e-6);
  EXPECT_NEAR(confidences[3], 0.3, 1e-6);
}

TEST(VertexConfidences, StayWithinThoseOfTheFacets) {
  Random random(1);
  const TriangleMesh mesh = MakeCube();
  std::vector<float> facets;
  for (size_t i = 0; i < mesh.facets.size(); ++i) {
    facets.push_back(static_cast<float>(random.Unit()));
  }
  for (const float confidence : VertexConfidences(mesh, facets)) {
    EXPECT_GE(confidence, *std::min_element(facets.begin(), facets.end()));
    EXPECT_LE(confidence, *std::max_element(facets.begin(), facets.end()));
  }
  const std::vector<float> ones(facets.size(), 1);
  EXPECT_EQ(VertexConfidences(mesh, ones),
            std::vector<float>(mesh.vertices.size(), 1));
}

TEST(VertexConfidences, AVertexWithoutFacetsHasNone) {
  EXPECT_EQ(VertexConfidences({{{0, 0, 0}}, {}}, {}), std::vector<float>{0});
}

TEST(MeanOfCorners, IsThat) {
  EXPECT_EQ(MeanOfCorners({{0, 1, 2}, {2, 2, 1}}, {0, 0.5f, 1}),
            (std::vector<float>{0.5f, 2.5f / 3}));
}

}  // namespace confidences_test
}  // namespace colmap_ext
