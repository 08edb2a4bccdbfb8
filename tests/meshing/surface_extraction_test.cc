#include "meshing/fix_singular_vertices.h"

#include <algorithm>
#include <map>
#include <set>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "base/union_find.h"
#include "mesh/adjacency.h"
#include "mesh/split_fans.h"
#include "meshing/finish_surface.h"
#include "tests/delaunay/random_complex.h"
#include "tests/mesh/known_meshes.h"
#include "tests/mesh/manifold_links.h"

namespace colmap_ext::surface_extraction_test {

// A few points in general position or on a small lattice.
Tetrahedralization SmallComplex(Random* random) {
  for (;;) {
    const uint32_t num_points = 4 + random->Below(40);
    const int range = random->Chance(0.3) ? 2 : 1000;
    try {
      return DelaunayOf(RandomPoints(num_points, range, random));
    } catch (const std::invalid_argument&) {
      // They lie in a plane.
    }
  }
}

double MatterVolume(const Tetrahedralization& tetrahedra,
                    const std::vector<uint8_t>& is_free) {
  double volume = 0;
  for (uint32_t cell = 0; cell < tetrahedra.cells.size(); ++cell) {
    if (is_free[cell] || tetrahedra.IsInfinite(cell)) {
      continue;
    }
    const auto corner = [&](int k) -> Eigen::Vector3d {
      return tetrahedra.PositionOf(tetrahedra.cells[cell].vertices[k]);
    };
    volume += (corner(1) - corner(0))
                  .cross(corner(2) - corner(0))
                  .dot(corner(3) - corner(0)) /
              6;
  }
  return volume;
}

// Oriented facets, the lowest vertex first.
std::multiset<Facet> Oriented(const std::vector<Facet>& facets) {
  std::multiset<Facet> oriented;
  for (Facet facet : facets) {
    std::rotate(facet.begin(), std::ranges::min_element(facet), facet.end());
    oriented.insert(facet);
  }
  return oriented;
}

TEST(ExtractSurface, HasTheFacetsBetweenMatterAndFreeSeenFromFree) {
  Random random(1);
  for (int trial = 0; trial < 500; ++trial) {
    const Tetrahedralization tetrahedra = SmallComplex(&random);
    const std::vector<uint8_t> labels = RandomLabels(tetrahedra, &random);
    std::vector<Facet> expected;
    for (size_t index = 0; index < tetrahedra.cells.size(); ++index) {
      const auto& cell = tetrahedra.cells[index];
      for (int i = 0; i < 4; ++i) {
        // Of a free cell: its facets' normals point into it.
        if (!labels[index] || labels[cell.neighbors[i]]) {
          continue;
        }
        const Facet facet = FacetVertices(cell, i);
        if (std::ranges::max(facet) != kInfiniteVertex) {
          expected.push_back(facet);
        }
      }
    }
    const ExtractedSurface surface = ExtractSurface(tetrahedra, labels);
    ASSERT_EQ(surface.mesh.vertices, tetrahedra.points);
    ASSERT_EQ(Oriented(surface.mesh.facets), Oriented(expected));
  }
}

// Cells around an edge that matter connects, and the surface facets that bound
// them there: always two, or one where the other goes to infinity.
TEST(ExtractSurface, PartnersBoundTheSameMatterAroundTheirEdge) {
  Random random(2);
  size_t num_shared = 0;
  for (int trial = 0; trial < 150; ++trial) {
    const Tetrahedralization tetrahedra = SmallComplex(&random);
    const std::vector<uint8_t> labels = RandomLabels(tetrahedra, &random);
    const ExtractedSurface surface = ExtractSurface(tetrahedra, labels);
    const std::vector<Facet>& facets = surface.mesh.facets;
    ASSERT_EQ(surface.partners.size(), 3 * facets.size());
    // The matter behind each facet.
    std::map<Facet, uint32_t> matter;
    for (uint32_t index = 0; index < tetrahedra.cells.size(); ++index) {
      for (int i = 0; i < 4 && !labels[index]; ++i) {
        const auto [a, b, c] = FacetVertices(tetrahedra.cells[index], i);
        matter[*Oriented({{a, c, b}}).begin()] = index;
      }
    }
    ForEachEdge(facets, [&](auto first, auto last) {
      const uint32_t u = FromVertex(facets, first->second);
      const uint32_t v = ToVertex(facets, first->second);
      const auto has_edge = [&](uint32_t cell) {
        const auto& vertices = tetrahedra.cells[cell].vertices;
        return std::ranges::count(vertices, u) +
                   std::ranges::count(vertices, v) ==
               2;
      };
      UnionFind components(tetrahedra.cells.size());
      for (uint32_t cell = 0; cell < tetrahedra.cells.size(); ++cell) {
        for (const uint32_t other : tetrahedra.cells[cell].neighbors) {
          if (!labels[cell] && !labels[other] && has_edge(cell) &&
              has_edge(other)) {
            components.Join(cell, other);
          }
        }
      }
      const auto component = [&](uint32_t half) {
        return components.Find(
            matter.at(*Oriented({facets[half / 3]}).begin()));
      };
      for (auto half = first; half != last; ++half) {
        uint32_t expected = kNone;
        for (auto other = first; other != last; ++other) {
          if (other != half &&
              component(other->second) == component(half->second)) {
            ASSERT_EQ(expected, kNone);
            expected = other->second;
          }
        }
        ASSERT_EQ(surface.partners[half->second], expected);
        if (expected != kNone) {
          ASSERT_EQ(FromVertex(facets, expected),
                    ToVertex(facets, half->second));
        }
      }
      num_shared += last - first > 2;
    });
    ASSERT_FALSE(HasFailure());
  }
  EXPECT_GT(num_shared, 100u);
}

TEST(ExtractSurface, EveryLabelingEndsManifold) {
  Random random(3);
  size_t num_midpoints = 0;
  size_t num_borders = 0;
  size_t num_surfaces = 0;
  for (int complex = 0; complex < 100; ++complex) {
    const Tetrahedralization tetrahedra = SmallComplex(&random);
    for (int trial = 0; trial < 40; ++trial) {
      std::vector<uint8_t> labels = RandomLabels(tetrahedra, &random);
      const uint32_t beyond = random.Below(3);
      if (beyond < 2) {
        LabelInfinite(tetrahedra, beyond == 1, &labels);
      }
      const ExtractedSurface surface = ExtractSurface(tetrahedra, labels);
      const FanSplit split = SplitFans(surface.mesh, surface.partners);
      const MeshReport report = ExpectManifoldMesh(split.mesh);
      if (beyond < 2) {
        ASSERT_EQ(report.num_border_edges, 0u);
      }
      if (beyond == 1) {
        const double volume = MatterVolume(tetrahedra, labels);
        ASSERT_NEAR(Volume(split.mesh), volume, 1e-6 * volume);
      }
      num_midpoints += split.num_midpoints;
      num_borders += report.num_border_edges > 0;
      num_surfaces += report.num_facets > 0;
    }
  }
  EXPECT_GT(num_surfaces, 3000u);
  EXPECT_GT(num_midpoints, 100u);
  EXPECT_GT(num_borders, 500u);
}

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

}  // namespace colmap_ext::surface_extraction_test
