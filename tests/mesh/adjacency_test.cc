#include "mesh/adjacency.h"

#include <algorithm>
#include <map>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "tests/mesh/shapes.h"
#include "tests/threads.h"

namespace colmap_ext {
namespace adjacency_test {

TEST(HalfEdges, RunAroundTheirFacet) {
  const std::vector<Facet> facets = {{4, 7, 9}, {7, 4, 2}};
  EXPECT_EQ(FromVertex(facets, 0), 4);
  EXPECT_EQ(ToVertex(facets, 0), 7);
  EXPECT_EQ(FromVertex(facets, 5), 2);
  EXPECT_EQ(ToVertex(facets, 5), 7);
  for (uint32_t half = 0; half < 6; ++half) {
    EXPECT_EQ(NextHalfEdge(half) / 3, half / 3);
    EXPECT_EQ(ToVertex(facets, half), FromVertex(facets, NextHalfEdge(half)));
  }
}

TEST(ForEachEdge, GathersTheHalfEdgesOfEachEdge) {
  Random random(1);
  for (const TriangleMesh& mesh :
       {TriangleMesh(), MakeTetrahedron(), MakeAnnulus(),
        RandomSoup(9, 40, true, &random)}) {
    const std::vector<Facet>& facets = mesh.facets;
    std::map<std::set<uint32_t>, std::vector<uint32_t>> expected;
    for (uint32_t half = 0; half < 3 * facets.size(); ++half) {
      expected[{FromVertex(facets, half), ToVertex(facets, half)}].push_back(
          half);
    }
    std::map<std::set<uint32_t>, std::vector<uint32_t>> edges;
    std::vector<std::set<uint32_t>> in_order;
    ForEachEdge(facets, [&](auto first, auto last) {
      std::vector<uint32_t> edge;
      for (auto it = first; it != last; ++it) {
        edge.push_back(it->second);
      }
      const std::set<uint32_t> vertices = {FromVertex(facets, edge[0]),
                                           ToVertex(facets, edge[0])};
      EXPECT_TRUE(edges.emplace(vertices, edge).second);
      in_order.push_back(vertices);
    });
    EXPECT_EQ(edges, expected);
    EXPECT_TRUE(std::ranges::is_sorted(in_order));
  }
}

TEST(PairHalfEdges, PairsWhatTwoFacetsRunInOppositeDirections) {
  Random random(1);
  size_t num_paired = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const TriangleMesh mesh = RandomSoup(8, 14, trial % 2 == 0, &random);
    const std::vector<uint32_t> partners = PairHalfEdges(mesh.facets);
    ASSERT_EQ(partners.size(), 3 * mesh.facets.size());
    for (uint32_t half = 0; half < partners.size(); ++half) {
      std::vector<uint32_t> others;  // of the undirected edge
      const uint32_t from = FromVertex(mesh.facets, half);
      const uint32_t to = ToVertex(mesh.facets, half);
      for (uint32_t other = 0; other < partners.size(); ++other) {
        const std::set<uint32_t> ends = {FromVertex(mesh.facets, other),
                                         ToVertex(mesh.facets, other)};
        if (other != half && ends == std::set<uint32_t>{from, to}) {
          others.push_back(other);
        }
      }
      const bool is_paired =
          others.size() == 1 && FromVertex(mesh.facets, others.front()) == to;
      ASSERT_EQ(partners[half], is_paired ? others.front() : kNone);
      num_paired += is_paired ? 1 : 0;
    }
  }
  EXPECT_GT(num_paired, 1000u);  // or it was not tested
}

TEST(PairHalfEdges, LeavesNoneOfAClosedMeshAlone) {
  for (const TriangleMesh& mesh :
       {MakeTetrahedron(), MakeTorus(), MakeCube()}) {
    for (const uint32_t partner : PairHalfEdges(mesh.facets)) {
      EXPECT_NE(partner, kNone);
    }
  }
}

// From the definitions.
void ExpectRings(const TriangleMesh& mesh) {
  const VertexRings rings = MakeVertexRings(mesh);
  const size_t num_vertices = mesh.vertices.size();
  ASSERT_EQ(rings.NumVertices(), num_vertices);
  ASSERT_EQ(rings.neighbors.offsets.size(), num_vertices + 1);
  ASSERT_EQ(rings.corners.offsets.size(), num_vertices + 1);
  // [V] how many facets the edge to each neighbour has.
  std::vector<std::map<uint32_t, int>> edges(num_vertices);
  std::vector<std::vector<uint32_t>> corners(num_vertices);
  for (uint32_t corner = 0; corner < 3 * mesh.facets.size(); ++corner) {
    const Facet& facet = mesh.facets[corner / 3];
    corners[facet[corner % 3]].push_back(corner);
    ++edges[facet[corner % 3]][facet[(corner + 1) % 3]];
    ++edges[facet[corner % 3]][facet[(corner + 2) % 3]];
  }
  for (size_t v = 0; v < num_vertices; ++v) {
    EXPECT_TRUE(std::ranges::equal(rings.corners[v], corners[v]));
    std::vector<uint32_t> expected;
    bool is_border = false;
    for (const auto& [neighbor, num_facets] : edges[v]) {
      expected.push_back(neighbor);
      is_border |= num_facets == 1;
    }
    EXPECT_TRUE(std::ranges::equal(rings.neighbors[v], expected));
    EXPECT_EQ(rings.is_border[v] != 0, is_border);
  }
}

TEST(VertexRings, AreWhatTheFacetsSay) {
  for (const TriangleMesh& mesh :
       {TriangleMesh(), MakeTetrahedron(), MakeTorus(), MakeDisc(),
        MakeAnnulus(), MakeMoebiusStrip(), MakeBumpyCap(0.1f)}) {
    ExpectRings(mesh);
  }
}

TEST(VertexRings, OfRandomSoups) {
  Random random(1);
  for (int trial = 0; trial < 500; ++trial) {
    ExpectRings(RandomSoup(4 + random.Below(8), random.Below(20),
                           /*allow_duplicates=*/true, &random));
    ASSERT_FALSE(HasFailure());
  }
}

TEST(VertexRings, AreTheSameForAnyNumberOfThreads) {
  const TriangleMesh mesh = MakeBumpySphere(0.03f);
  ExpectSameForAnyThreads([&] { return MakeVertexRings(mesh); });
}

}  // namespace adjacency_test
}  // namespace colmap_ext
