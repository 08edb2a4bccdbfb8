#include "mesh/normals.h"

#include <gtest/gtest.h>

#include "tests/mesh/shapes.h"
#include "tests/threads.h"

namespace colmap_ext {
namespace normals_test {

using Eigen::Vector3f;

std::vector<Vector3f> VertexNormals(const TriangleMesh& mesh) {
  return VertexNormals(mesh, MakeVertexRings(mesh));
}

TEST(Normals, OfASpherePointOutwards) {
  const TriangleMesh mesh = MakeBumpySphere(0.1f, 0);
  const std::vector<Vector3f> of_facets = FacetNormals(mesh);
  for (size_t i = 0; i < mesh.facets.size(); ++i) {
    EXPECT_NEAR(of_facets[i].norm(), 1, 1e-6);
    EXPECT_GT(of_facets[i].dot(mesh.vertices[mesh.facets[i][0]]), 0.9f);
  }
  const std::vector<Vector3f> of_vertices = VertexNormals(mesh);
  for (size_t i = 0; i < mesh.vertices.size(); ++i) {
    EXPECT_NEAR(of_vertices[i].norm(), 1, 1e-6);
    EXPECT_GT(of_vertices[i].dot(mesh.vertices[i].normalized()), 0.99f);
  }
}

TEST(Normals, AreZeroWhereThereIsNone) {
  const TriangleMesh line = {{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {5, 5, 5}},
                             {{0, 1, 2}}};
  EXPECT_EQ(FacetNormals(line).front(), Vector3f::Zero());
  EXPECT_EQ(VertexNormals(line), std::vector<Vector3f>(4, Vector3f(0, 0, 0)));
  EXPECT_TRUE(FacetNormals(TriangleMesh()).empty());
  EXPECT_TRUE(VertexNormals(TriangleMesh()).empty());
}

TEST(FacetNormals, OfTinyFacetsAreUnit) {
  const TriangleMesh mesh =
      Moved(MakeTetrahedron(), [](const auto& p) { return 1e-20f * p; });
  EXPECT_EQ(FacetNormals(mesh), FacetNormals(MakeTetrahedron()));
}

TEST(CountFlippedFacets, CountsThoseThatTurnOver) {
  const TriangleMesh mesh = MakeDisc();
  const auto count = [&](const TriangleMesh& moved) {
    return CountFlippedFacets(mesh.facets, mesh.vertices, moved.vertices);
  };
  EXPECT_EQ(count(mesh), 0u);
  EXPECT_EQ(count(Moved(mesh,
                        [](const Vector3f& p) {  // steep, but no overhang
                          return Vector3f(p.x(), p.y(), 10 * p.x() * p.y());
                        })),
            0u);
  TriangleMesh moved = mesh;
  moved.vertices[2 * 8 + 3].x() += 1.5f;  // across the edges to its right
  EXPECT_EQ(count(moved), 2u);
  EXPECT_EQ(count(Moved(mesh,
                        [](const Vector3f& p) {
                          return Vector3f(-p.x(), p.y(), p.z());
                        })),
            mesh.facets.size());
  EXPECT_EQ(CountFlippedFacets({}, {}, {}), 0u);
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

TEST(Normals, AreTheSameForAnyNumberOfThreads) {
  const TriangleMesh mesh = MakeBumpySphere(0.03f);
  ExpectSameForAnyThreads(
      [&] { return std::pair(FacetNormals(mesh), VertexNormals(mesh)); });
}

}  // namespace normals_test
}  // namespace colmap_ext
