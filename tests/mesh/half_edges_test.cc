#include "mesh/half_edges.h"

#include <map>
#include <set>

#include <gtest/gtest.h>

#include "tests/mesh/known_meshes.h"
#include "tests/mesh/random_soup.h"

namespace colmap_ext {
namespace {

TEST(HalfEdges, RunAroundTheirFacet) {
  const std::vector<Facet> facets = {{4, 7, 9}, {7, 4, 2}};
  EXPECT_EQ(FromVertex(facets, 0), 4);
  EXPECT_EQ(ToVertex(facets, 0), 7);
  EXPECT_EQ(FromVertex(facets, 5), 2);
  EXPECT_EQ(ToVertex(facets, 5), 7);
  for (uint32_t half = 0; half < 6; ++half) {
    const uint32_t next = half / 3 * 3 + (half + 1) % 3;
    EXPECT_EQ(ToVertex(facets, half), FromVertex(facets, next));
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
    const auto halves = SortedHalfEdges(facets);
    ForEachEdge(halves, [&](auto first, auto last) {
      std::vector<uint32_t> edge;
      for (auto it = first; it != last; ++it) {
        edge.push_back(it->second);
        EXPECT_EQ(it->first, first->first);
      }
      const std::set<uint32_t> vertices = {FromVertex(facets, edge[0]),
                                           ToVertex(facets, edge[0])};
      EXPECT_TRUE(edges.emplace(vertices, edge).second);
    });
    EXPECT_EQ(edges, expected);
  }
}

}  // namespace
}  // namespace colmap_ext
