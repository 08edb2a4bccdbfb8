#include "mesh/normals.h"

#include <gtest/gtest.h>

#include "tests/mesh/known_meshes.h"
#include "tests/mesh/shapes.h"
#include "tests/threads.h"

namespace colmap_ext {
namespace normals_test {

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
  ExpectSameForAnyThreads([&] { return FacetNormals(mesh); });
}

std::vector<Vector3f> VertexNormals(const TriangleMesh& mesh) {
  return VertexNormals(mesh, MakeVertexRings(mesh));
}

TEST(VertexNormals, OfASpherePointOutwards) {
  const TriangleMesh mesh = MakeBumpySphere(0.1f, 0);
  const std::vector<Vector3f> normals = VertexNormals(mesh);
  for (size_t i = 0; i < mesh.vertices.size(); ++i) {
    EXPECT_NEAR(normals[i].norm(), 1, 1e-6);
    EXPECT_GT(normals[i].dot(mesh.vertices[i].normalized()), 0.99f);
  }
}

// Weighted by angles they do not depend on how the sides are cut in facets.
TEST(VertexNormals, OfACubesCornersPointAlongItsDiagonals) {
  const TriangleMesh cube = MakeCube();
  const std::vector<Vector3f> normals = VertexNormals(cube);
  for (size_t i = 0; i < cube.vertices.size(); ++i) {
    const Vector3f diagonal =
        (cube.vertices[i] - Vector3f::Constant(0.5f)).normalized();
    EXPECT_LT((normals[i] - diagonal).norm(), 1e-6);
  }
}

TEST(VertexNormals, AreZeroWhereThereIsNone) {
  const TriangleMesh line = {{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {5, 5, 5}},
                             {{0, 1, 2}}};
  EXPECT_EQ(VertexNormals(line), std::vector<Vector3f>(4, Vector3f(0, 0, 0)));
  EXPECT_TRUE(VertexNormals(TriangleMesh()).empty());
}

TEST(VertexNormals, AreTheSameForAnyNumberOfThreads) {
  const TriangleMesh mesh = MakeBumpySphere(0.03f);
  ExpectSameForAnyThreads([&] { return VertexNormals(mesh); });
}

}  // namespace normals_test
}  // namespace colmap_ext
