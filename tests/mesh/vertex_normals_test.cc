#include "mesh/vertex_normals.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "tests/mesh/known_meshes.h"
#include "tests/mesh/shapes.h"

namespace colmap_ext {
namespace vertex_normals_test {

using Eigen::Vector3f;

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
  const std::vector<Vector3f> expected = VertexNormals(mesh);
  for (const size_t num_threads : {1, 2, 7}) {
    const tbb::global_control control(
        tbb::global_control::max_allowed_parallelism, num_threads);
    EXPECT_EQ(VertexNormals(mesh), expected);
  }
}

}  // namespace vertex_normals_test
}  // namespace colmap_ext
