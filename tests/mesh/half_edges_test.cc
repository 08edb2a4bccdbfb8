#include "mesh/half_edges.h"

#include <algorithm>
#include <map>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "tests/mesh/known_meshes.h"
#include "tests/mesh/random_soup.h"

namespace colmap_ext {
namespace half_edges_test {

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
  for (int trial = 0; trial < 300; ++trial) {
    const TriangleMesh mesh = RandomSoup(8, 14, true, &random);
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
    }
  }
}

TEST(PairHalfEdges, IsItsOwnInverse) {
  Random random(2);
  size_t num_pairs = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const TriangleMesh mesh = RandomSoup(9, 20, false, &random);
    const std::vector<uint32_t> partners = PairHalfEdges(mesh.facets);
    for (uint32_t half = 0; half < partners.size(); ++half) {
      if (partners[half] != kNone) {
        EXPECT_EQ(partners[partners[half]], half);
        EXPECT_EQ(FromVertex(mesh.facets, partners[half]),
                  ToVertex(mesh.facets, half));
        EXPECT_EQ(ToVertex(mesh.facets, partners[half]),
                  FromVertex(mesh.facets, half));
        ++num_pairs;
      }
    }
  }
  EXPECT_GT(num_pairs, 1000u);  // or it was not tested
}

TEST(PairHalfEdges, LeavesNoneOfAClosedMeshAlone) {
  for (const TriangleMesh& mesh :
       {MakeTetrahedron(), MakeTorus(), MakeCube()}) {
    for (const uint32_t partner : PairHalfEdges(mesh.facets)) {
      EXPECT_NE(partner, kNone);
    }
  }
}

}  // namespace half_edges_test
}  // namespace colmap_ext
