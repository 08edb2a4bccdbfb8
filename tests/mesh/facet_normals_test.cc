#include "mesh/facet_normals.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "tests/mesh/known_meshes.h"
#include "tests/mesh/shapes.h"

namespace colmap_ext {
namespace facet_normals_test {

using Eigen::Vector3f;

TEST(FacetNormals, OfASpherePointOutwards) {
  const TriangleMesh mesh = MakeBumpySphere(0.1f, 0);
  const std::vector<Vector3f> normals = FacetNormals(mesh);
  for (size_t i = 0; i < mesh.facets.size(); ++i) {
    EXPECT_NEAR(normals[i].norm(), 1, 1e-6);
    EXPECT_GT(normals[i].dot(mesh.vertices[mesh.facets[i][0]]), 0.9f);
  }
}

TEST(FacetNormals, AreZeroWhereThereIsNone) {
  const TriangleMesh line = {{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {5, 5, 5}},
                             {{0, 1, 2}}};
  EXPECT_EQ(FacetNormals(line).front(), Vector3f::Zero());
  EXPECT_TRUE(FacetNormals(TriangleMesh()).empty());
}

TEST(FacetNormals, OfTinyFacetsAreUnit) {
  TriangleMesh mesh = MakeTetrahedron();
  for (Vector3f& vertex : mesh.vertices) {
    vertex *= 1e-20f;
  }
  EXPECT_EQ(FacetNormals(mesh), FacetNormals(MakeTetrahedron()));
}

TEST(CountFlippedFacets, CountsThoseThatTurnOver) {
  const TriangleMesh mesh = MakeDisc();
  EXPECT_EQ(CountFlippedFacets(mesh.facets, mesh.vertices, mesh.vertices), 0u);
  TriangleMesh moved = mesh;
  for (Vector3f& vertex : moved.vertices) {
    vertex.z() = 10 * vertex.x() * vertex.y();  // steep, but no overhang
  }
  EXPECT_EQ(CountFlippedFacets(mesh.facets, mesh.vertices, moved.vertices), 0u);
  moved = mesh;
  moved.vertices[2 * 8 + 3].x() += 1.5f;  // across the edges to its right
  EXPECT_EQ(CountFlippedFacets(mesh.facets, mesh.vertices, moved.vertices), 2u);
  for (Vector3f& vertex : moved.vertices) {
    vertex = mesh.vertices[&vertex - moved.vertices.data()];
    vertex.x() *= -1;
  }
  EXPECT_EQ(CountFlippedFacets(mesh.facets, mesh.vertices, moved.vertices),
            mesh.facets.size());
  EXPECT_EQ(CountFlippedFacets({}, {}, {}), 0u);
}

TEST(FacetNormals, AreTheSameForAnyNumberOfThreads) {
  const TriangleMesh mesh = MakeBumpySphere(0.03f);
  const std::vector<Vector3f> expected = FacetNormals(mesh);
  for (const size_t num_threads : {1, 2, 7}) {
    const tbb::global_control control(
        tbb::global_control::max_allowed_parallelism, num_threads);
    EXPECT_EQ(FacetNormals(mesh), expected);
  }
}

}  // namespace facet_normals_test
}  // namespace colmap_ext
