#include "meshing/finish_surface.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace colmap_ext::inherit_attributes_test {

// Three points, seen by views {0, 1}, {1, 2} and {1}.
VertexAttributes MakePoints() {
  return {{{0, 10, 255}, {1, 20, 255}, {200, 30, 254}},
          Rows<uint32_t>({0, 2, 4, 5}, {0, 1, 1, 2, 1})};
}

using Points = std::vector<std::array<uint32_t, 2>>;

struct Row {
  Color color;
  std::vector<uint32_t> views;
};

// Those of the points.
const Row kFirst = {{0, 10, 255}, {0, 1}};
const Row kSecond = {{1, 20, 255}, {1, 2}};
const Row kThird = {{200, 30, 254}, {1}};

void ExpectRows(const VertexAttributes& attributes,
                const std::vector<Row>& rows) {
  ASSERT_EQ(attributes.colors.size(), rows.size());
  ASSERT_EQ(attributes.views.size(), rows.size());
  for (size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(attributes.colors[i], rows[i].color) << i;
    EXPECT_TRUE(std::ranges::equal(attributes.views[i], rows[i].views)) << i;
  }
}

TriangleMesh MakeMesh(uint32_t num_vertices, std::vector<Facet> facets) {
  TriangleMesh mesh;
  mesh.vertices.resize(num_vertices, {0, 0, 0});
  mesh.facets = std::move(facets);
  return mesh;
}

TEST(InheritAttributes, OfThePointItselfOrTheMeanOfTwoAndTheViewsOfBoth) {
  ExpectRows(InheritAttributes(MakeMesh(3, {{0, 1, 2}}),
                               {{2, 2}, {0, 0}, {1, 1}}, MakePoints()),
             {kThird, kFirst, kSecond});
  ExpectRows(InheritAttributes(MakeMesh(1, {}), {{0, 1}}, MakePoints()),
             {{{1, 15, 255}, {0, 1, 2}}});
}

// A centroid between all three: views that at least half of them have.
TEST(InheritAttributes, FromNeighborsOfANeighborOrNoneOnAnIsland) {
  const TriangleMesh mesh = MakeMesh(4, {{3, 0, 1}, {3, 1, 2}, {3, 2, 0}});
  const Points points = {{0, 0}, {1, 1}, {2, 2}, {kNone, kNone}};
  ExpectRows(InheritAttributes(mesh, points, MakePoints()),
             {kFirst, kSecond, kThird, {{67, 20, 255}, {1}}});
  const TriangleMesh fan =
      MakeMesh(5, {{4, 0, 1}, {4, 1, 2}, {4, 2, 3}, {4, 3, 0}});
  const Points twins = {{0, 0}, {0, 0}, {1, 1}, {1, 1}, {kNone, kNone}};
  ExpectRows(InheritAttributes(fan, twins, MakePoints()),
             {kFirst, kFirst, kSecond, kSecond, {{1, 15, 255}, {0, 1, 2}}});
  // Vertex 3 knows vertex 0 and is known to vertex 4, which knows no other.
  const TriangleMesh chain = MakeMesh(6, {{0, 3, 4}, {3, 4, 5}});
  const Points known = {{0, 0},         {1, 1},     {2, 2},
                        {kNone, kNone}, {0, kNone}, {kNone, kNone}};
  ExpectRows(InheritAttributes(chain, known, MakePoints()),
             {kFirst, kSecond, kThird, kFirst, kFirst, kFirst});
  const TriangleMesh island = MakeMesh(3, {{0, 1, 2}});
  const Points unknown(3, {kNone, kNone});
  const Row none = {{0, 0, 0}, {}};
  ExpectRows(InheritAttributes(island, unknown, MakePoints()),
             {none, none, none});
}

TEST(InheritAttributes, WithoutColours) {
  VertexAttributes points = MakePoints();
  points.colors.clear();
  const VertexAttributes attributes =
      InheritAttributes(MakeMesh(2, {}), {{0, 0}, {2, 1}}, points);
  EXPECT_TRUE(attributes.colors.empty());
  EXPECT_EQ(attributes.views, Rows<uint32_t>({0, 2, 4}, {0, 1, 1, 2}));
}

TEST(SupportOfVertices, AddsUpThePointsOfEach) {
  EXPECT_EQ(SupportOfVertices(3, {0, 2, 0, 2}, {1, 2, 4, 8}),
            (std::vector<float>{5, 0, 10}));
}

TEST(MeansOfSources, IsTheMeanOfBoth) {
  EXPECT_EQ(MeansOfSources({1, 3}, {{0, 0}, {0, 1}, {2, 2}, {1, 2}}, 7),
            (std::vector<float>{1, 2, 7, 5}));
}

}  // namespace colmap_ext::inherit_attributes_test
