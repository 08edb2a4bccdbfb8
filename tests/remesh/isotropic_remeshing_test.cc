#include "remesh/isotropic_remeshing.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <Eigen/Geometry>

#include "mesh/facet_normals.h"
#include "remesh/edge_length_field.h"
#include "tests/mesh/known_meshes.h"
#include "tests/mesh/same_topology.h"
#include "tests/mesh/shapes.h"
#include "tests/remesh/mesh_measures.h"

namespace colmap_ext {
namespace isotropic_remeshing_test {

using Eigen::Vector3f;

RemeshedSurface Remesh(const TriangleMesh& mesh, float length,
                       float tolerance) {
  return RemeshIsotropically(
      mesh, std::vector<float>(mesh.vertices.size(), length),
      std::vector<float>(mesh.vertices.size(), tolerance * length));
}

// A sheet of needles: rows close together, columns far apart.
TriangleMesh MakeNeedles() {
  TriangleMesh mesh = MakeSheet(40, 4);
  for (uint32_t i = 0; i < mesh.vertices.size(); ++i) {
    mesh.vertices[i] = {static_cast<float>(i / 5) * 0.02F,
                        static_cast<float>(i % 5) * 0.25F, 0};
  }
  return mesh;
}

TEST(RemeshIsotropically, ShapesFacetsAndKeepsTheSurface) {
  for (const TriangleMesh& mesh :
       {MakeBumpySphere(0.1F), MakeBumpyCap(0.1F), MakeRoundTorus(0.1F)}) {
    for (const float length : {0.05F, 0.1F, 0.16F}) {
      const RemeshedSurface result = Remesh(mesh, length, 0.1F);
      ExpectSameTopology(mesh, result.mesh);
      const std::vector<double> angles = SmallestAngles(result.mesh);
      EXPECT_GT(Percentile(angles, 0.5), 42) << length;
      EXPECT_GT(Percentile(angles, 0.02), 20) << length;
      EXPECT_LT(Distance(result.mesh, mesh), 0.2 * length);
      EXPECT_LT(Distance(mesh, result.mesh), 0.3 * length);
      // Facets of the size that is wanted.
      const double wanted = Area(mesh) / (std::sqrt(3.0) / 4 * length * length);
      EXPECT_NEAR(result.mesh.facets.size() / wanted, 1, 0.35) << length;
    }
  }
}

TEST(RemeshIsotropically, SourcesAreWhereTheVerticesAre) {
  const TriangleMesh mesh = MakeBumpyCap(0.1F);
  const RemeshedSurface result = Remesh(mesh, 0.07F, 0.1F);
  ASSERT_EQ(result.sources.size(), result.mesh.vertices.size());
  for (size_t i = 0; i < result.sources.size(); ++i) {
    const SurfacePoint& source = result.sources[i];
    ASSERT_LT(source.facet, mesh.facets.size());
    EXPECT_NEAR(source.weights.sum(), 1, 1e-5);
    EXPECT_GE(source.weights.minCoeff(), 0);
    EXPECT_LT(
        (ValueAt(source, mesh, mesh.vertices) - result.mesh.vertices[i]).norm(),
        0.01F);
  }
}

// The edges and corners of a cube stay where they are, up to the tolerance.
TEST(RemeshIsotropically, CreasesSurvive) {
  const TriangleMesh cube = MakeFineCube(0.15F);
  const float length = 0.2F;
  const RemeshedSurface result = Remesh(cube, length, 0.1F);
  ExpectSameTopology(cube, result.mesh);
  EXPECT_LT(Distance(result.mesh, cube), 0.1 * length + 1e-4);
  EXPECT_LT(Distance(cube, result.mesh), 0.2 * length);
  EXPECT_NEAR(Area(result.mesh), Area(cube), 0.02 * Area(cube));
}

TEST(RemeshIsotropically, BordersStay) {
  Random random(3);
  const TriangleMesh square = MakeJitteredSquare(20, &random);
  const RemeshedSurface result = Remesh(square, 0.08F, 0.1F);
  ExpectSameTopology(square, result.mesh);
  EXPECT_NEAR(Area(result.mesh), 1, 1e-4);
  EXPECT_LT(Distance(square, result.mesh), 1e-4);
}

// What a mesh should not be: needles, and facets without an area.
TEST(RemeshIsotropically, NeedlesAndCapsBecomeFacets) {
  TriangleMesh needles = MakeNeedles();
  const RemeshedSurface result = Remesh(needles, 0.06F, 0.1F);
  ExpectSameTopology(needles, result.mesh);
  EXPECT_GT(Percentile(SmallestAngles(result.mesh), 0.02), 20);
  EXPECT_NEAR(Area(result.mesh), Area(needles), 1e-4);

  // Pull inner vertices onto their neighbors, and onto the edge across.
  Random random(4);
  TriangleMesh caps = MakeJitteredSquare(20, &random);
  for (uint32_t i = 23; i < caps.vertices.size() - 23; i += 3) {
    if (i % 21 != 0 && i % 21 != 20) {
      caps.vertices[i] = caps.vertices[i + 1];
    }
  }
  const RemeshedSurface repaired = Remesh(caps, 0.07F, 0.1F);
  ExpectSameTopology(caps, repaired.mesh);
  EXPECT_GT(Percentile(SmallestAngles(repaired.mesh), 0.05), 10);
}

// Facets grow with the lengths that are wanted.
TEST(RemeshIsotropically, FollowsTheLengths) {
  Random random(5);
  const TriangleMesh square = MakeJitteredSquare(40, &random);
  std::vector<float> lengths(square.vertices.size());
  for (size_t i = 0; i < lengths.size(); ++i) {
    lengths[i] = 0.02F + 0.1F * square.vertices[i].x();
  }
  const RemeshedSurface result = RemeshIsotropically(
      square, lengths, std::vector<float>(lengths.size(), 0.01F));
  ExpectSameTopology(square, result.mesh);
  std::vector<double> ratios;
  for (const auto& [a, b, c] : result.mesh.facets) {
    const Vector3f& from = result.mesh.vertices[a];
    const Vector3f& to = result.mesh.vertices[b];
    ratios.push_back((to - from).norm() / (0.02 + 0.05 * (from + to).x()));
  }
  EXPECT_NEAR(Percentile(ratios, 0.5), 1, 0.15);
  EXPECT_GT(Percentile(ratios, 0.05), 0.6);
  EXPECT_LT(Percentile(ratios, 0.95), 1.5);
}

TEST(RemeshIsotropically, AnyManifoldMeshStaysOne) {
  Random random(6);
  for (int i = 0; i < 20; ++i) {
    const TriangleMesh mesh = MakeRandomManifold(&random);
    ExpectSameTopology(mesh, Remesh(mesh, 0.3F, 0.1F).mesh);
  }
}

TEST(RemeshIsotropically, TheSameWithAnyNumberOfThreads) {
  const TriangleMesh mesh = MakeBumpySphere(0.1F);
  const RemeshedSurface many = Remesh(mesh, 0.06F, 0.1F);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism,
                                1);
  const RemeshedSurface single = Remesh(mesh, 0.06F, 0.1F);
  EXPECT_EQ(many.mesh.facets, single.mesh.facets);
  EXPECT_EQ(many.mesh.vertices, single.mesh.vertices);
}

}  // namespace isotropic_remeshing_test
}  // namespace colmap_ext
