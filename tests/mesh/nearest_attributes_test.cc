#include "mesh/nearest_attributes.h"

#include <gtest/gtest.h>

#include "tests/mesh/known_meshes.h"

namespace colmap_ext {
namespace {

// One a vertex of the cube, a little off, seen by views i and i + 1.
PointCloud PointsNearCube() {
  PointCloud points;
  for (uint32_t i = 0; i < 8; ++i) {
    points.positions.push_back(MakeCube().vertices[i] +
                               Eigen::Vector3f(0.01f, 0, 0));
    points.colors.push_back({static_cast<uint8_t>(i), 0, 255});
    points.view_indices.insert(points.view_indices.end(), {i, i + 1});
    points.view_offsets.push_back(points.view_indices.size());
  }
  return points;
}

TEST(NearestAttributesTest, TakesTheColorOfTheNearestPoint) {
  const PointCloud points = PointsNearCube();
  const VertexAttributes attributes = NearestAttributes(MakeCube(), points);
  EXPECT_EQ(attributes.colors, points.colors);
}

TEST(NearestAttributesTest, TakesTheViewsOfAFew) {
  TriangleMesh mesh = MakeCube();
  PointCloud points = PointsNearCube();
  const VertexAttributes attributes = NearestAttributes(mesh, points);
  ASSERT_EQ(attributes.view_offsets.size(), 9);
  for (uint32_t i = 0; i < 8; ++i) {
    const auto views = attributes.Views(i);
    EXPECT_TRUE(std::is_sorted(views.begin(), views.end()));
    EXPECT_EQ(std::adjacent_find(views.begin(), views.end()), views.end());
    EXPECT_TRUE(std::binary_search(views.begin(), views.end(), i));
    EXPECT_TRUE(std::binary_search(views.begin(), views.end(), i + 1));
    EXPECT_LE(views.size(), 8);
  }
}

TEST(NearestAttributesTest, LeavesWhatIsFarFromAllPointsWithoutViews) {
  TriangleMesh mesh = MakeCube();
  for (Eigen::Vector3f& vertex : mesh.vertices) {
    vertex.x() += 100;
  }
  PointCloud points = PointsNearCube();
  points.colors.clear();
  const VertexAttributes attributes = NearestAttributes(mesh, points);
  EXPECT_TRUE(attributes.view_indices.empty());
  EXPECT_EQ(attributes.view_offsets.size(), 9);
  EXPECT_TRUE(attributes.colors.empty());
}

}  // namespace
}  // namespace colmap_ext
