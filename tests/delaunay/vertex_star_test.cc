#include "delaunay/vertex_star.h"

#include <algorithm>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "delaunay/surface_extraction.h"
#include "mesh/topology.h"
#include "tests/delaunay/random_complex.h"

namespace colmap_ext {
namespace {

using Link = std::map<uint32_t, std::set<uint32_t>>;  // of each vertex, others

// Around each vertex, the edges of the facets between free space and matter,
// those at infinity included.
std::vector<Link> BoundaryLinks(const Tetrahedralization& tetrahedra,
                                const std::vector<uint8_t>& is_free) {
  std::vector<Link> links(tetrahedra.points.size());
  for (size_t index = 0; index < tetrahedra.cells.size(); ++index) {
    const auto& cell = tetrahedra.cells[index];
    for (int i = 0; i < 4; ++i) {
      if (is_free[index] == is_free[cell.neighbors[i]]) {
        continue;
      }
      for (const int u : kFacetCorners[i]) {
        for (const int v : kFacetCorners[i]) {
          for (const int w : kFacetCorners[i]) {
            if (u != v && v != w && w != u &&
                cell.vertices[u] != kInfiniteVertex) {
              links[cell.vertices[u]][cell.vertices[v]].insert(
                  cell.vertices[w]);
            }
          }
        }
      }
    }
  }
  return links;
}

// Whether there is no boundary around the vertex, or one fan: each neighbor has
// two facets, and all hang together.
bool IsRegular(const Link& link) {
  if (link.empty()) {
    return true;
  }
  std::set<uint32_t> reached = {link.begin()->first};
  std::vector<uint32_t> stack = {link.begin()->first};
  while (!stack.empty()) {
    const std::set<uint32_t>& others = link.at(stack.back());
    stack.pop_back();
    if (others.size() != 2) {
      return false;
    }
    for (const uint32_t other : others) {
      if (reached.insert(other).second) {
        stack.push_back(other);
      }
    }
  }
  return reached.size() == link.size();
}

TEST(VertexStar, IsSingularWhereTheSurfaceIsNotOneFan) {
  Random random(1);
  size_t num_singular = 0;
  size_t num_regular = 0;
  for (const auto& [name, points] : DifficultPoints()) {
    SCOPED_TRACE(name);
    const Tetrahedralization tetrahedra = DelaunayOf(points);
    for (int trial = 0; trial < 40; ++trial) {
      std::vector<uint8_t> labels = RandomLabels(tetrahedra, &random);
      if (random.Chance(0.3)) {
        LabelInfinite(tetrahedra, true, &labels);
      }
      const std::vector<Link> links = BoundaryLinks(tetrahedra, labels);
      std::vector<uint32_t> expected;
      for (uint32_t vertex = 0; vertex < links.size(); ++vertex) {
        const bool is_singular = !IsRegular(links[vertex]);
        ASSERT_EQ(IsSingular(tetrahedra, labels, vertex), is_singular);
        if (is_singular) {
          expected.push_back(vertex);
        }
        num_regular += !is_singular && !links[vertex].empty();
      }
      ASSERT_EQ(SingularVertices(tetrahedra, labels), expected);
      num_singular += expected.size();
    }
  }
  EXPECT_GT(num_singular, 1000u);
  EXPECT_GT(num_regular, 1000u);
}

// Where space beyond the hull is free, the surface tells by itself.
TEST(VertexStar, SingularVerticesAreThoseOfTheSurface) {
  Random random(2);
  for (int trial = 0; trial < 300; ++trial) {
    const Tetrahedralization tetrahedra =
        DelaunayOf(RandomPoints(5 + random.Below(40), 50, &random));
    std::vector<uint8_t> labels = RandomLabels(tetrahedra, &random);
    LabelInfinite(tetrahedra, true, &labels);
    const MeshReport report = Analyze(ExtractSurface(tetrahedra, labels).mesh);
    ASSERT_EQ(SingularVertices(tetrahedra, labels).size(),
              report.num_singular_vertices);
  }
}

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
    for (size_t i = 0; i < star.components.size(); ++i) {
      const auto& component = star.components[i];
      ASSERT_FALSE(component.cells.empty());
      for (const uint32_t cell : component.cells) {
        ASSERT_EQ(labels[cell] != 0, component.is_free);
        ASSERT_TRUE(components.emplace(cell, i).second);
      }
      const uint32_t lowest =
          *std::min_element(component.cells.begin(), component.cells.end());
      ASSERT_TRUE(i == 0 || lowest > last_lowest);
      last_lowest = lowest;
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
    EXPECT_TRUE(SingularVertices(tetrahedra, labels).empty());
    VertexStar star;
    MakeVertexStar(tetrahedra, labels, 13, &star);
    ASSERT_EQ(star.components.size(), 1u);
    EXPECT_EQ(star.components[0].is_free, label == 1);
  }
}

}  // namespace
}  // namespace colmap_ext
