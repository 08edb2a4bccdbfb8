#include "mesh/split_fans.h"

#include <algorithm>
#include <limits>
#include <map>

#include <gtest/gtest.h>

#include "mesh/adjacency.h"
#include "mesh/surface.h"
#include "tests/mesh/known_meshes.h"
#include "tests/mesh/manifold_links.h"

namespace colmap_ext::split_fans_test {

size_t CountUsed(TriangleMesh mesh) { return DropUnusedVertices(&mesh).size(); }

// Pairs half-edges of opposite directions at random, some not at all, where
// any number of facets shares an edge.
std::vector<uint32_t> RandomPartners(const std::vector<Facet>& facets,
                                     Random* random) {
  std::vector<uint32_t> partners(3 * facets.size(), kNone);
  std::map<std::pair<uint32_t, uint32_t>, std::vector<uint32_t>> unpaired;
  const std::vector<uint32_t> order = random->Permutation(partners.size());
  for (const uint32_t half : order) {
    const uint32_t from = FromVertex(facets, half);
    const uint32_t to = ToVertex(facets, half);
    auto& candidates = unpaired[{to, from}];
    if (candidates.empty() || random->Chance(0.1)) {
      unpaired[{from, to}].push_back(half);
    } else {
      partners[half] = candidates.back();
      partners[candidates.back()] = half;
      candidates.pop_back();
    }
  }
  return partners;
}

// What holds for any split.
void ExpectSameSurface(const TriangleMesh& mesh, const FanSplit& split) {
  EXPECT_NEAR(Area(split.mesh), Area(mesh), 1e-5 * (1 + Area(mesh)));
  ASSERT_EQ(split.from.vertices.size(), split.mesh.vertices.size());
  EXPECT_EQ(split.mesh.vertices.size(),
            CountUsed(mesh) + split.num_split_vertices + split.num_midpoints);
  size_t num_midpoints = 0;
  for (size_t i = 0; i < split.from.vertices.size(); ++i) {
    const auto [a, b] = split.from.vertices[i];
    num_midpoints += a != b;
    EXPECT_EQ(split.mesh.vertices[i],
              0.5f * (mesh.vertices[a] + mesh.vertices[b]));
  }
  EXPECT_EQ(num_midpoints, split.num_midpoints);
  if (split.num_midpoints > 0) {
    return;
  }
  ASSERT_EQ(split.mesh.facets.size(), mesh.facets.size());
  for (size_t i = 0; i < mesh.facets.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      EXPECT_EQ(split.from.vertices[split.mesh.facets[i][k]][0],
                mesh.facets[i][k]);
    }
  }
}

void ExpectUnchanged(const TriangleMesh& mesh) {
  const FanSplit split = SplitFans(mesh);
  EXPECT_EQ(split.num_split_vertices, 0u);
  EXPECT_EQ(split.num_midpoints, 0u);
  EXPECT_EQ(RepairManifold(mesh).mesh, split.mesh);
  ExpectSameSurface(mesh, split);
  ExpectManifoldMesh(split.mesh);
  // Vertices in the order of their use.
  uint32_t next = 0;
  for (const Facet& facet : split.mesh.facets) {
    for (const uint32_t vertex : facet) {
      EXPECT_LE(vertex, next);
      next = std::max(next, vertex + 1);
    }
  }
}

TEST(SplitFans, LeavesManifoldMeshesAsTheyAre) {
  for (const TriangleMesh& mesh :
       {MakeTetrahedron(), MakeTorus(), MakeDisc(), MakeAnnulus(),
        Union(MakeTorus(), MakeCube())}) {
    ExpectUnchanged(mesh);
  }
}

void ExpectSplit(const TriangleMesh& mesh, const FanSplit& split) {
  ExpectManifoldMesh(split.mesh);
  ExpectSameSurface(mesh, split);
  ExpectUnchanged(split.mesh);
}

TEST(SplitFans, MakesAnySoupAndPairingManifold) {
  Random random(2);
  size_t num_midpoints = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const uint32_t num_vertices = 4 + random.Below(9);
    const TriangleMesh mesh = RandomSoup(
        num_vertices, 1 + random.Below(4 * num_vertices), false, &random);
    ExpectSplit(mesh, SplitFans(mesh));
    const FanSplit split =
        SplitFans(mesh, RandomPartners(mesh.facets, &random));
    ExpectSplit(mesh, split);
    ASSERT_FALSE(HasFailure());
    num_midpoints += split.num_midpoints;
  }
  EXPECT_GT(num_midpoints, 20u);  // or they would not have been tested
}

// Of two closed surfaces that met.
void ExpectCubes(const FanSplit& split, size_t num_split_vertices,
                 size_t num_midpoints, size_t num_components) {
  EXPECT_EQ(split.num_split_vertices, num_split_vertices);
  EXPECT_EQ(split.num_midpoints, num_midpoints);
  const MeshReport report = ExpectManifoldMesh(split.mesh);
  EXPECT_EQ(report.num_components, num_components);
  EXPECT_EQ(report.num_border_edges, 0u);
}

TEST(SplitFans, SeparatesCubesThatShareAVertexAndLeavesNothing) {
  TriangleMesh mesh = Union(MakeCube(), MakeCube());
  MergeVertices(8, 7, &mesh);
  ExpectCubes(SplitFans(mesh), 1, 0, 2);
  ExpectCubes(RepairManifold(mesh), 1, 0, 2);
  const FanSplit split = SplitFans({{{1, 2, 3}}, {}}, {});
  EXPECT_TRUE(split.mesh.vertices.empty());
  EXPECT_TRUE(split.mesh.facets.empty());
}

// Of two cubes along one edge the partners say which facets are one surface.
TEST(SplitFans, CubesThatShareAnEdgeAreSplitAsThePartnersSay) {
  TriangleMesh mesh = Union(MakeCube(), MakeCube());
  std::vector<uint32_t> partners = PairHalfEdges(mesh.facets);
  MergeVertices(9, 7, &mesh);
  MergeVertices(8, 6, &mesh);
  ExpectCubes(SplitFans(mesh, partners), 2, 0, 2);
  // The other way: each cube's facets go on in the other cube's.
  std::vector<uint32_t> halves;  // along the edge
  for (uint32_t half = 0; half < partners.size(); ++half) {
    const uint32_t from = FromVertex(mesh.facets, half);
    const uint32_t to = ToVertex(mesh.facets, half);
    if (std::minmax(from, to) == std::minmax(6u, 7u)) {
      halves.push_back(half);
    }
  }
  ASSERT_EQ(halves.size(), 4u);
  for (const uint32_t half : halves) {
    for (const uint32_t other : halves) {
      if (half / 36 != other / 36 &&
          FromVertex(mesh.facets, half) != FromVertex(mesh.facets, other)) {
        partners[half] = other;
      }
    }
  }
  // A midpoint where the fans touch themselves.
  ExpectCubes(SplitFans(mesh, partners), 0, 1, 1);
}

TEST(ManifoldRepairTest, CountsWhatItDrops) {
  TriangleMesh mesh = MakeCube();
  const auto first = static_cast<uint32_t>(mesh.vertices.size());
  mesh.vertices.emplace_back(std::numeric_limits<float>::quiet_NaN(), 0, 0);
  mesh.vertices.emplace_back(5, 5, 5);
  mesh.facets.push_back({0, 1, first});
  mesh.facets.push_back({0, 1, first + 10});
  mesh.facets.push_back({0, 1, 0});
  const Facet facet = mesh.facets[0];
  mesh.facets.push_back({facet[1], facet[0], facet[2]});
  const ManifoldRepair repair = RepairManifold(mesh);
  EXPECT_EQ(repair.num_invalid_facets, 2);
  EXPECT_EQ(repair.num_degenerate_facets, 1);
  EXPECT_EQ(repair.num_duplicate_facets, 1);
  EXPECT_EQ(repair.num_unused_vertices, 2);
  EXPECT_EQ(repair.num_split_vertices, 0);
  EXPECT_EQ(repair.mesh.facets, RepairManifold(MakeCube()).mesh.facets);
}

TEST(ManifoldRepairTest, MakesAnythingManifold) {
  Random random(3);
  for (int i = 0; i < 300; ++i) {
    TriangleMesh mesh = RandomSoup(3 + random.Below(8), random.Below(40),
                                   /*allow_duplicates=*/true, &random);
    for (Facet& facet : mesh.facets) {
      if (random.Chance(0.05)) {
        facet[random.Below(3)] = random.Below(12);
      }
    }
    const ManifoldRepair repair = RepairManifold(mesh);
    ExpectManifoldMesh(repair.mesh);
    ASSERT_EQ(repair.from.vertices.size(), repair.mesh.vertices.size());
    ASSERT_EQ(repair.from.facets.size(), repair.mesh.facets.size());
    for (size_t f = 0; f < repair.from.facets.size(); ++f) {
      const Facet& old = mesh.facets[repair.from.facets[f]];
      for (const uint32_t vertex : repair.mesh.facets[f]) {
        for (const uint32_t source : repair.from.vertices[vertex]) {
          EXPECT_NE(std::ranges::find(old, source), old.end());
        }
      }
    }
    for (size_t v = 0; v < repair.from.vertices.size(); ++v) {
      const auto& [a, b] = repair.from.vertices[v];
      EXPECT_TRUE(repair.mesh.vertices[v].isApprox(
          0.5f * (mesh.vertices[a] + mesh.vertices[b])));
    }
  }
}

}  // namespace colmap_ext::split_fans_test
