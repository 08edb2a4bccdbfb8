#include "mesh/manifold_repair.h"

#include <limits>

#include <gtest/gtest.h>

#include "mesh/topology.h"
#include "tests/mesh/known_meshes.h"
#include "tests/mesh/manifold_links.h"
#include "tests/mesh/random_soup.h"

namespace colmap_ext {
namespace manifold_repair_test {

TEST(ManifoldRepairTest, LeavesAManifoldMeshAsItIs) {
  for (const TriangleMesh& mesh : {MakeCube(), MakeTorus(), MakeAnnulus()}) {
    const ManifoldRepair repair = RepairManifold(mesh);
    EXPECT_EQ(repair.mesh.facets.size(), mesh.facets.size());
    EXPECT_EQ(repair.mesh.vertices.size(), mesh.vertices.size());
    EXPECT_EQ(repair.num_split_vertices, 0);
    EXPECT_EQ(repair.num_unused_vertices, 0);
  }
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

TEST(ManifoldRepairTest, SplitsWhereSheetsMeet) {
  TriangleMesh mesh = Union(MakeCube(), MakeCube());
  MergeVertices(0, 8, &mesh);
  const ManifoldRepair repair = RepairManifold(mesh);
  EXPECT_EQ(repair.num_split_vertices, 1);
  EXPECT_EQ(Analyze(repair.mesh).num_components, 2);
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
    EXPECT_TRUE(Analyze(repair.mesh).IsManifold())
        << Analyze(repair.mesh).Defects();
    EXPECT_TRUE(HasManifoldLinks(repair.mesh));
    ASSERT_EQ(repair.sources.size(), repair.mesh.vertices.size());
    for (size_t v = 0; v < repair.sources.size(); ++v) {
      const auto& [a, b] = repair.sources[v];
      EXPECT_TRUE(repair.mesh.vertices[v].isApprox(
          0.5f * (mesh.vertices[a] + mesh.vertices[b])));
    }
  }
}

}  // namespace manifold_repair_test
}  // namespace colmap_ext
