#include "mesh/confidences.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "scene/view.h"
#include "tests/mesh/known_meshes.h"
#include "tests/random.h"
#include "tests/threads.h"

namespace colmap_ext {
namespace confidences_test {

// A square grid of unit facets that three views look down on.
class FacetConfidencesTest : public testing::Test {
 protected:
  FacetConfidencesTest() {
    for (size_t i = 0; i < mesh_.vertices.size(); ++i) {
      AddSupport();
    }
    for (const double x : {0.0, 5.0, 10.0}) {
      views_.push_back(LookAtView({x, 0, 30}, {6, 6, 0},
                                  Eigen::Vector3d::UnitY(), 1000, 1000, 1000));
    }
  }

  void AddSupport() {
    vertex_views_.AddRow(std::vector<uint32_t>{0, 1, 2});
    support_.push_back(5);
  }

  // A facet from the corner of the grid to two new vertices far away, each with
  // as much support as the others.
  void AddMembrane() {
    const auto first = static_cast<uint32_t>(mesh_.vertices.size());
    mesh_.vertices.emplace_back(-20.0f, 0.0f, -1.0f);
    mesh_.vertices.emplace_back(0.0f, -20.0f, -1.0f);
    mesh_.facets.push_back({0, first, first + 1});
    AddSupport();
    AddSupport();
  }

  std::vector<float> Confidences() const {
    return FacetConfidences(mesh_, support_, vertex_views_, views_);
  }

  TriangleMesh mesh_ = MakeSheet(11, 11);
  std::vector<float> support_;
  Rows<uint32_t> vertex_views_;
  std::vector<View> views_;
};

// As far as `a` goes.
void ExpectNear(const std::vector<float>& a, const std::vector<float>& b,
                double tolerance = 1e-5) {
  ASSERT_LE(a.size(), b.size());
  for (size_t i = 0; i < a.size(); ++i) {
    EXPECT_NEAR(a[i], b[i], tolerance) << i;
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
  ExpectNear(before, Confidences(), 0.02);
}

TEST_F(FacetConfidencesTest, DependsOnNoScale) {
  Random random(1);
  for (float& support : support_) {
    support = static_cast<float>(1 + 10 * random.Unit());
  }
  const std::vector<float> confidences = Confidences();
  mesh_ = Moved(mesh_, [](const auto& point) { return 4 * point; });
  for (View& view : views_) {
    view.cam_from_world_translation *= 4;
  }
  ExpectNear(Confidences(), confidences);
  for (View& view : views_) {
    view = ResizeView(view, 500, 500);
  }
  ExpectNear(Confidences(), confidences);
  std::ranges::for_each(support_, [](float& support) { support *= 0.125f; });
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
    EXPECT_GE(confidence, std::ranges::min(facets));
    EXPECT_LE(confidence, std::ranges::max(facets));
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
