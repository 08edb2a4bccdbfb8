#include "mesh/surface.h"

#include <gtest/gtest.h>

#include "mesh/subdivision.h"
#include "tests/mesh/shapes.h"

namespace colmap_ext {
namespace surface_test {

DerivedMesh SubdivideAll(const TriangleMesh& mesh) {
  return Subdivide(mesh, std::vector<uint8_t>(mesh.facets.size(), 1));
}

TEST(Provenance, OfTwoStepsIsThatOfTheFirstMesh) {
  const TriangleMesh mesh = MakeBumpySphere(0.4f);
  const DerivedMesh once = SubdivideAll(mesh);
  EXPECT_EQ(Compose(IdentityOf(mesh), once.from), once.from);
  const DerivedMesh twice = SubdivideAll(once.mesh);
  const Provenance from = Compose(once.from, twice.from);
  ASSERT_EQ(from.vertices.size(), twice.mesh.vertices.size());
  ASSERT_EQ(from.facets.size(), 16 * mesh.facets.size());
  for (size_t i = 0; i < from.facets.size(); ++i) {
    EXPECT_EQ(from.facets[i], i / 16);
    for (const uint32_t vertex : twice.mesh.facets[i]) {
      for (const uint32_t source : from.vertices[vertex]) {
        EXPECT_LT(source, mesh.vertices.size());
      }
    }
  }
}

TEST(DropUnusedVertices, LeavesTheFacetsWhereTheyAre) {
  const TriangleMesh all = Union(MakeCube(), MakeTetrahedron());
  TriangleMesh mesh{all.vertices, MakeCube().facets};
  mesh.facets.erase(mesh.facets.begin(), mesh.facets.begin() + 8);
  const std::vector<Facet> before = mesh.facets;
  const std::vector<uint32_t> used = DropUnusedVertices(&mesh);
  ASSERT_EQ(used.size(), mesh.vertices.size());
  EXPECT_LT(used.size(), all.vertices.size());
  for (size_t i = 0; i < before.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      EXPECT_EQ(used[mesh.facets[i][k]], before[i][k]);
      EXPECT_EQ(mesh.vertices[mesh.facets[i][k]], all.vertices[before[i][k]]);
    }
  }
}

TEST(Surface, HandsDownWhatItsVerticesHave) {
  Surface surface{MakeDisc(), {}, MakeDisc().vertices};
  for (uint32_t i = 0; i < surface.mesh.vertices.size(); ++i) {
    surface.attributes.confidences.push_back(static_cast<float>(i % 2));
    surface.attributes.views.AddRow(std::vector<uint32_t>{i % 3});
    surface.fixed_sources.push_back(i % 2 == 0 ? 100 + i : kNone);
  }
  const Surface before = surface;
  DerivedMesh derived = SubdivideAll(surface.mesh);
  const Provenance from = derived.from;
  surface.Become(std::move(derived));
  EXPECT_EQ(surface.origins, surface.mesh.vertices);
  for (size_t i = 0; i < from.vertices.size(); ++i) {
    const auto& [a, b] = from.vertices[i];
    EXPECT_EQ(surface.fixed_sources[i],
              a == b ? before.fixed_sources[a] : kNone);
    EXPECT_EQ(
        surface.attributes.confidences[i],
        (before.attributes.confidences[a] + before.attributes.confidences[b]) /
            2);
  }
}

}  // namespace surface_test
}  // namespace colmap_ext
