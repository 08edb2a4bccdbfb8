#include "refine/refined_confidences.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "tests/look_at.h"
#include "tests/mesh/known_meshes.h"
#include "tests/threads.h"

namespace colmap_ext::refined_confidences_test {

// Of windows of weight 1.
float EnergyOf(double correlation) {
  const double saturation = 1 + PhotometricOptions().residual_floor;
  return static_cast<float>(saturation *
                            std::log(1 - correlation / saturation));
}

// Terms of weight 1 whose correlation is that of a function of the facet's
// first corner.
template <typename Zncc>
PhotometricTerms TermsOf(const TriangleMesh& mesh, const Zncc& zncc) {
  PhotometricTerms terms;
  for (const Facet& facet : mesh.facets) {
    terms.facets.push_back({EnergyOf(zncc(mesh.vertices[facet[0]])), 1});
  }
  return terms;
}

std::vector<uint8_t> Confirmed(const TriangleMesh& mesh,
                               const PhotometricTerms& terms,
                               double min_zncc = 0.5) {
  return ConfirmedFacets(mesh, MakeVertexRings(mesh), terms, {}, min_zncc);
}

TEST(ConfirmedFacets, AreThoseOfTheHalfThatCorrelates) {
  const TriangleMesh mesh = MakeBumpySphere(0.06F);
  const std::vector<uint8_t> is_confirmed =
      Confirmed(mesh, TermsOf(mesh, [](const Eigen::Vector3f& at) {
                  return at.x() > 0 ? 0.9 : 0.05;
                }));
  for (size_t i = 0; i < mesh.facets.size(); ++i) {
    const float x = mesh.vertices[mesh.facets[i][0]].x();
    if (std::abs(x) > 0.3F) {
      EXPECT_EQ(is_confirmed[i] != 0, x > 0) << x;
    }
  }
}

// One bad facet among good ones, as a highlight makes it, is no reason.
TEST(ConfirmedFacets, DependOnTheSurroundings) {
  const TriangleMesh mesh = MakeBumpySphere(0.06F);
  PhotometricTerms terms =
      TermsOf(mesh, [](const Eigen::Vector3f& /*at*/) { return 0.9; });
  terms.facets[7].energy = 0;
  EXPECT_EQ(Confirmed(mesh, terms),
            std::vector<uint8_t>(mesh.facets.size(), 1));
}

TEST(ConfirmedFacets, AreAllWhereNothingIsComparedOrAsked) {
  const TriangleMesh mesh = MakeBumpySphere(0.1F);
  PhotometricTerms terms =
      TermsOf(mesh, [](const Eigen::Vector3f& /*at*/) { return -0.5; });
  const std::vector<uint8_t> none(mesh.facets.size(), 0);
  const std::vector<uint8_t> all(mesh.facets.size(), 1);
  EXPECT_EQ(Confirmed(mesh, terms), none);
  EXPECT_EQ(Confirmed(mesh, terms, -1), all);
  terms.facets.assign(mesh.facets.size(), {});
  EXPECT_EQ(Confirmed(mesh, terms), all);
}

// A sheet of 20 x 20 unit quads in z = 0 that two views look down on from
// above, and points on its left half.
class PointConfidencesTest : public testing::Test {
 protected:
  PointConfidencesTest() : mesh_(MakeSheet(kSide, kSide)) {
    for (size_t i = 0; i < mesh_.vertices.size(); ++i) {
      vertex_views_.AddRow(std::vector<uint32_t>{0, 1});
    }
    for (const double x : {8.0, 12.0}) {
      views_.push_back(LookAtView({x, 10, 30}, {10, 10, 0},
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
  points_ = {};
  EXPECT_EQ(Confidences(), std::vector<float>(confidences.size(), 0));
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
  EXPECT_EQ(Confidences(), std::vector<float>(mesh_.vertices.size(), 0));
}

TEST_F(PointConfidencesTest, IsTheSameAtAnyNumberOfThreads) {
  ExpectSameForAnyThreads([&] { return Confidences(); });
}

const TriangleMesh kMesh = MakeTorus();
const std::vector<float> kHalf(kMesh.vertices.size(), 0.5f);

// What windows of the same correlation and texture give on each facet.
PhotometricTerms MakeTerms(double correlation, float texture,
                           float num_pixels = 10) {
  const float weight = texture * num_pixels;
  return {0, std::vector<FacetTerms>(
                 kMesh.facets.size(),
                 {weight * EnergyOf(correlation), weight, num_pixels})};
}

void ExpectAll(const std::vector<float>& confidences, double value) {
  ASSERT_EQ(confidences.size(), kMesh.vertices.size());
  for (const float confidence : confidences) {
    EXPECT_NEAR(confidence, value, 1e-5);
  }
}

std::vector<float> Confidences(const PhotometricTerms& terms,
                               const std::vector<float>& before) {
  return RefinedConfidences(kMesh, terms, {}, before);
}

TEST(RefinedConfidences, IsTheCorrelationWhereThereIsTexture) {
  for (const double correlation : {0.6, 0.8, 0.99}) {
    ExpectAll(Confidences(MakeTerms(correlation, 1), kHalf), correlation);
  }
}

TEST(RefinedConfidences, StaysWhereOnlyPointsConfirm) {
  ExpectAll(Confidences(MakeTerms(0.3, 1), kHalf), 0.5);
  ExpectAll(Confidences(MakeTerms(-0.5, 1), kHalf), 0.5);
  ExpectAll(Confidences(MakeTerms(-0.5, 1), {}), 0);
}

TEST(RefinedConfidences, IsTheInputsWhereThereIsNoTextureOrNothingIsSeen) {
  ExpectAll(Confidences(MakeTerms(0.9, 0), kHalf), 0.5);
  ExpectAll(Confidences(MakeTerms(0.9, 0.25), kHalf), 0.6);
  ExpectAll(Confidences(MakeTerms(0.9, 1, 0), kHalf), 0.5);
  ExpectAll(Confidences(MakeTerms(0.9, 1, 0), {}), 0);
}

TEST(RefinedConfidences, LiesWithinItsRange) {
  ExpectAll(Confidences(MakeTerms(1.04, 1), kHalf), 1);
  Random random(1);
  PhotometricTerms terms = MakeTerms(0, 1);
  for (size_t i = 0; i < kMesh.facets.size(); ++i) {
    terms.facets[i].energy = static_cast<float>(100 * (random.Unit() - 0.8));
    terms.facets[i].weight = static_cast<float>(10.01 * random.Unit());
  }
  for (const float confidence : Confidences(terms, kHalf)) {
    EXPECT_GE(confidence, 0);
    EXPECT_LE(confidence, 1);
  }
}

// Of a sheet of quads in the plane z = 0 that looks up.
TEST(FrontShares, SayByHowMuchFrontsOutweighBacks) {
  const TriangleMesh mesh = MakeSheet(4, 4);
  const View above = LookAt({2, 2, 10}, {2, 2, 0}, 80, 60, 60);
  const View aside = LookAt({4, 1, 10}, {2, 2, 0}, 80, 60, 60);
  const View below = LookAt({1, 2, -10}, {2, 2, 0}, 80, 60, 60);
  const std::vector<std::pair<std::vector<View>, float>> cases = {
      {{}, 1},      {{above}, 1},        {{above, aside}, 1},
      {{below}, 0}, {{above, below}, 0}, {{above, aside, below}, 1.0F / 3}};
  for (const auto& [views, expected] : cases) {
    for (const float share : FrontShares({mesh, views, 0.1, SIZE_MAX})) {
      EXPECT_NEAR(share, expected, 1e-6F) << views.size();
    }
  }
}

// It is closed, and hides its own back, but for facets that views graze.
TEST(FrontShares, AreOneOfABody) {
  const TriangleMesh mesh = MakeBumpySphere(0.1F);
  const std::vector<View> views = {LookAt({0, 0, 4}, {0, 0, 0}, 640, 480, 480),
                                   LookAt({4, 0, 1}, {0, 0, 0}, 640, 480, 480)};
  const std::vector<float> shares = FrontShares({mesh, views, 0.1, SIZE_MAX});
  ASSERT_EQ(shares.size(), mesh.facets.size());
  EXPECT_GT(std::ranges::count(shares, 1.0F),
            0.95 * static_cast<double>(shares.size()));
}

}  // namespace colmap_ext::refined_confidences_test
