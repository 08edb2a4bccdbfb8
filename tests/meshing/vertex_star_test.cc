#include "meshing/singular_vertices.h"

#include <algorithm>
#include <map>

#include <gtest/gtest.h>

#include "tests/delaunay/random_complex.h"

namespace colmap_ext {
namespace vertex_star_test {

TEST(VertexStar, ComponentsAreTheConnectedCellsOfOneLabel) {
  Random random(3);
  const Tetrahedralization tetrahedra =
      DelaunayOf(RandomPoints(100, 1000, &random));
  const std::vector<uint8_t> labels = RandomLabels(tetrahedra, &random);
  for (uint32_t vertex = 0; vertex < tetrahedra.points.size(); ++vertex) {
    VertexStar star;
    MakeVertexStar(tetrahedra, labels, vertex, &star);
    std::map<uint32_t, size_t> components;  // of cells
    uint32_t last_lowest = 0;
    for (size_t i = 0; i < star.NumComponents(); ++i) {
      const auto component = star.Component(i);
      ASSERT_FALSE(component.empty());
      for (const uint32_t cell : component) {
        ASSERT_EQ(labels[cell], star.is_free[i]);
        ASSERT_TRUE(components.emplace(cell, i).second);
      }
      ASSERT_EQ(component.front(),
                *std::min_element(component.begin(), component.end()));
      ASSERT_TRUE(i == 0 || component.front() > last_lowest);
      last_lowest = component.front();
    }
    std::vector<uint32_t> cells;
    IncidentCells(tetrahedra, vertex, &cells);
    ASSERT_EQ(components.size(), cells.size());
    // Cells on both sides of a facet with the vertex: one component just where
    // they have one label. That a component hangs together is in the count.
    for (const uint32_t cell : cells) {
      for (int k = 0; k < 4; ++k) {
        const uint32_t neighbor = tetrahedra.cells[cell].neighbors[k];
        if (tetrahedra.cells[cell].vertices[k] != vertex) {
          ASSERT_EQ(components.at(cell) == components.at(neighbor),
                    labels[cell] == labels[neighbor]);
        }
      }
    }
  }
}

TEST(VertexStar, WithinOneLabelThereIsOneComponent) {
  const Tetrahedralization tetrahedra = DelaunayOf(GridPoints(3));
  for (const uint8_t label : {0, 1}) {
    const std::vector<uint8_t> labels(tetrahedra.cells.size(), label);
    VertexStar star;
    MakeVertexStar(tetrahedra, labels, 13, &star);
    ASSERT_EQ(star.NumComponents(), 1u);
    EXPECT_EQ(star.is_free[0], label);
  }
}

}  // namespace vertex_star_test
}  // namespace colmap_ext
