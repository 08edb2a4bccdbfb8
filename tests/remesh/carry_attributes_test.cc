#include "remesh/carry_attributes.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "remesh/remesh_evenly.h"
#include "tests/mesh/same_topology.h"
#include "tests/mesh/shapes.h"

namespace colmap_ext {
namespace carry_attributes_test {

// One facet whose corners differ in everything.
struct OneFacet {
  OneFacet() {
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.facets = {{0, 1, 2}};
    attributes.colors = {{0, 0, 0}, {100, 0, 0}, {0, 200, 7}};
    attributes.confidences = {0, 0.5F, 1};
    for (const std::vector<uint32_t>& views :
         {std::vector<uint32_t>{1, 4}, {2}, {1, 9}}) {
      attributes.views.AddRow(views);
    }
  }

  TriangleMesh mesh;
  VertexAttributes attributes;
};

TEST(CarryAttributes, AtCornersAreTheirs) {
  const OneFacet one;
  std::vector<SurfacePoint> corners;
  for (int k = 0; k < 3; ++k) {
    corners.push_back({0, Eigen::Vector3f::Unit(k)});
  }
  const VertexAttributes carried =
      CarryAttributes(one.mesh, one.attributes, corners);
  EXPECT_EQ(carried.colors, one.attributes.colors);
  EXPECT_EQ(carried.confidences, one.attributes.confidences);
  EXPECT_EQ(carried.views, one.attributes.views);
}

TEST(CarryAttributes, BetweenCornersAreOfThoseThatHaveAPart) {
  const OneFacet one;
  const VertexAttributes carried = CarryAttributes(
      one.mesh, one.attributes, {{0, {0, 0.25F, 0.75F}}, {0, {0.5F, 0.5F, 0}}});
  EXPECT_EQ(carried.colors[0], (Color{25, 150, 5}));
  EXPECT_FLOAT_EQ(carried.confidences[0], 0.875F);
  EXPECT_TRUE(
      std::ranges::equal(carried.views[0], std::vector<uint32_t>{1, 2, 9}));
  EXPECT_TRUE(
      std::ranges::equal(carried.views[1], std::vector<uint32_t>{1, 2, 4}));
}

TEST(CarryAttributes, WithoutColorsAreWithout) {
  OneFacet one;
  one.attributes.colors.clear();
  one.attributes.confidences.clear();
  const VertexAttributes carried =
      CarryAttributes(one.mesh, one.attributes, {{0, {1, 0, 0}}});
  EXPECT_TRUE(carried.colors.empty());
  EXPECT_TRUE(carried.confidences.empty());
}

TEST(RemeshEvenly, KeepsTheNumberOfFacetsAndCarriesAttributes) {
  const TriangleMesh before = MakeBumpyCap(0.1F);
  TriangleMesh mesh = before;
  VertexAttributes attributes;
  for (const Eigen::Vector3f& vertex : mesh.vertices) {
    attributes.confidences.push_back((vertex.x() + 2) / 4);
    attributes.views.AddRow(std::vector<uint32_t>{3});
  }
  RemeshEvenly(&mesh, &attributes);
  ExpectSameTopology(before, mesh);
  EXPECT_NEAR(static_cast<double>(mesh.facets.size()) / before.facets.size(), 1,
              0.4);
  ASSERT_EQ(attributes.confidences.size(), mesh.vertices.size());
  ASSERT_EQ(attributes.views.size(), mesh.vertices.size());
  for (size_t i = 0; i < mesh.vertices.size(); ++i) {
    EXPECT_NEAR(attributes.confidences[i], (mesh.vertices[i].x() + 2) / 4,
                0.01);
    EXPECT_EQ(attributes.views[i].size(), 1);
  }
}

}  // namespace carry_attributes_test
}  // namespace colmap_ext
