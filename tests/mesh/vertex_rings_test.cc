#include "mesh/vertex_rings.h"

#include <map>
#include <set>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "tests/mesh/known_meshes.h"
#include "tests/mesh/random_soup.h"
#include "tests/mesh/shapes.h"

namespace colmap_ext {
namespace vertex_rings_test {

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
    const auto row = rings.corners[v];
    EXPECT_EQ(std::vector<uint32_t>(row.begin(), row.end()), corners[v]);
    std::vector<uint32_t> expected;
    bool is_border = false;
    for (const auto& [neighbor, num_facets] : edges[v]) {
      expected.push_back(neighbor);
      is_border |= num_facets == 1;
    }
    const auto neighbors = rings.neighbors[v];
    EXPECT_EQ(std::vector<uint32_t>(neighbors.begin(), neighbors.end()),
              expected);
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
  const VertexRings expected = MakeVertexRings(mesh);
  for (const size_t num_threads : {1, 2, 7}) {
    const tbb::global_control control(
        tbb::global_control::max_allowed_parallelism, num_threads);
    const VertexRings rings = MakeVertexRings(mesh);
    EXPECT_EQ(rings.neighbors.offsets, expected.neighbors.offsets);
    EXPECT_EQ(rings.neighbors, expected.neighbors);
    EXPECT_EQ(rings.corners.offsets, expected.corners.offsets);
    EXPECT_EQ(rings.corners, expected.corners);
    EXPECT_EQ(rings.is_border, expected.is_border);
  }
}

}  // namespace vertex_rings_test
}  // namespace colmap_ext
