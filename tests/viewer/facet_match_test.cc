#include "viewer/shown_scene.h"

#include <cmath>

#include <gtest/gtest.h>

#include "mesh/normals.h"
#include "pictures/pictures.h"
#include "scene/view.h"
#include "tests/mesh/known_meshes.h"
#include "tests/raster/pixels.h"

namespace colmap_ext::facet_match_test {

// A textured plane z = 0, and images of it.
struct FacetMatchTest : testing::Test {
  static View ViewFrom(const Eigen::Vector3d& eye, const std::string& name) {
    View view = LookAtView(eye, {0, 0, 0}, {0, 1, 0}, 200, 160, 260);
    view.name = name;
    return view;
  }

  // What a camera sees of the plane, moved in z and seen where it is not.
  static GrayImage ImageOf(const View& view, double height = 0) {
    GrayImage image{view.width, view.height, {}};
    ForEachPixel(view, [&](int row, int col) {
      const Eigen::Vector3d ray =
          RayDirection(view, col + 0.5, row + 0.5).cast<double>();
      const Eigen::Vector3d eye = view.Center();
      const Eigen::Vector3d point = eye + (height - eye.z()) / ray.z() * ray;
      image.pixels.push_back(static_cast<uint8_t>(
          128 + 50 * std::sin(43 * point.x() + 5 * std::sin(31 * point.y())) +
          40 * std::cos(37 * point.y())));
    });
    return image;
  }

  const View first_ = ViewFrom({0.3, 0.2, 3}, "first");
  const View second_ = ViewFrom({-0.5, 0.1, 2.8}, "a second one");
  const TriangleMesh mesh_ = {{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}},
                              {{0, 1, 2}, {0, 2, 3}}};
};

TEST_F(FacetMatchTest, ImagesOfTheSurfaceAgreeAndOfAnotherDoNot) {
  const FacetMatch match =
      MatchFacet(mesh_, 0, first_, ImageOf(first_), second_, ImageOf(second_));
  ASSERT_TRUE(match.zncc);
  EXPECT_GT(*match.zncc, 0.97);
  ASSERT_EQ(match.first.pixels.size(), match.warped.pixels.size());
  double difference = 0;
  for (size_t i = 0; i < match.first.pixels.size(); ++i) {
    difference += std::abs(match.first.pixels[i] - match.warped.pixels[i]);
  }
  EXPECT_LT(difference / match.first.pixels.size(), 6);
  const FacetMatch other = MatchFacet(mesh_, 0, first_, ImageOf(first_, 0.3),
                                      second_, ImageOf(second_, 0.3));
  ASSERT_TRUE(other.zncc);
  EXPECT_LT(*other.zncc, 0.6);
}

TEST_F(FacetMatchTest, WhatIsHiddenOrBehindIsNotCompared) {
  const TriangleMesh hidden = Union(mesh_, Shifted(mesh_, {0, 0, 0.5F}));
  EXPECT_FALSE(
      MatchFacet(hidden, 0, first_, ImageOf(first_), second_, ImageOf(second_))
          .zncc);
  const View behind = ViewFrom({0, 0, -3}, "behind");
  EXPECT_FALSE(
      MatchFacet(mesh_, 0, first_, ImageOf(first_), behind, ImageOf(behind))
          .zncc);
}

TEST_F(FacetMatchTest, PairsComeFromLabelsWithSpacesInNames) {
  ShownMesh shown;
  shown.mesh = mesh_;
  const std::vector<View> views = {second_, first_};
  EXPECT_FALSE(PairOfFacet(shown, 0, views));
  shown.labels = {0, -1};
  shown.label_names = {"first a second one"};
  EXPECT_EQ(PairOfFacet(shown, 0, views), (ViewPair{1, 0}));
  EXPECT_FALSE(PairOfFacet(shown, 1, views));
  shown.label_names = {"first another"};
  EXPECT_FALSE(PairOfFacet(shown, 0, views));
}

TEST(ShrinkPicture, KeepsMeansAndAspect) {
  ColorImage image{100, 50, std::vector<Color>(5000, {10, 20, 30})};
  image.pixels[0] = {110, 20, 30};
  const ColorImage small = ShrinkPicture(image, 25);
  EXPECT_EQ(small.width, 25);
  EXPECT_EQ(small.height, 12);
  EXPECT_GT(small.pixels[0][0], 10);
  EXPECT_EQ(small.pixels[1], (Color{10, 20, 30}));
  EXPECT_EQ(ShrinkPicture(image, 100).pixels, image.pixels);
}

TEST(CoarseMesh, IsOfAboutAsManyFacetsOnTheSameSurface) {
  constexpr int kSize = 200;
  ShownMesh fine;
  fine.mesh = MakeSheet(kSize, kSize);
  for (Eigen::Vector3f& vertex : fine.mesh.vertices) {
    vertex = {0.01F * vertex.x(), 0.01F * vertex.y(), 1};
    fine.confidences.push_back(vertex.x() / 2);
  }
  for (size_t i = 0; i < fine.mesh.facets.size(); ++i) {
    fine.labels.push_back(i / 2 % kSize < kSize / 2 ? 0 : 1);
  }
  const ShownMesh coarse = CoarseMesh(fine, 2000);
  EXPECT_GT(coarse.mesh.facets.size(), 500);
  EXPECT_LT(coarse.mesh.facets.size(), 4000);
  ASSERT_EQ(coarse.confidences.size(), coarse.mesh.vertices.size());
  ASSERT_EQ(coarse.labels.size(), coarse.mesh.facets.size());
  double area = 0;
  for (const Facet& facet : coarse.mesh.facets) {
    const float doubled = AreaVector(coarse.mesh, facet).z();
    EXPECT_GE(doubled, -1e-6);  // upwards, as they were
    area += 0.5 * doubled;
  }
  EXPECT_NEAR(area, 4, 0.3);
  for (size_t i = 0; i < coarse.mesh.vertices.size(); ++i) {
    EXPECT_NEAR(coarse.confidences[i], coarse.mesh.vertices[i].x() / 2, 1e-5);
  }
}

}  // namespace colmap_ext::facet_match_test
