#include "tests/synthetic/isosurface.h"

#include <numbers>

#include <gtest/gtest.h>

#include "mesh/topology.h"
#include "tests/mesh/shapes.h"
#include "tests/synthetic/noise.h"
#include "tests/synthetic/scene.h"

namespace colmap_ext::synthetic::isosurface_test {

using Eigen::Vector3f;

TEST(MeshSolid, BallIsASphere) {
  Solid ball;
  ball.box = {Vector3f(-1, -1, -1), Vector3f(1, 1, 1)};
  ball.shape = [](const Vector3f& p) { return p.norm() - 0.7f; };
  ball.detail = [](const Vector3f&) { return 0.0f; };
  const TriangleMesh mesh = MeshSolid(ball, 0.06f);
  const MeshReport report = Analyze(mesh);
  EXPECT_TRUE(report.IsManifold()) << report.Defects();
  EXPECT_EQ(report.num_border_edges, 0);
  EXPECT_EQ(report.euler, 2);
  for (const Vector3f& vertex : mesh.vertices) {
    EXPECT_NEAR(vertex.norm(), 0.7f, 1e-3f);
  }
  EXPECT_NEAR(Volume(mesh), 4 / 3.0 * std::numbers::pi * 0.343, 0.01);
}

TEST(MeshSolid, NoiseIsManifold) {
  for (uint32_t seed = 0; seed < 5; ++seed) {
    Solid solid;
    solid.box = {Vector3f(-1, -1, -1), Vector3f(1, 1, 1)};
    solid.shape = [seed](const Vector3f& p) {
      return 0.3f * ValueNoise(3 * p, seed);
    };
    solid.max_detail = 0.1f;
    solid.detail = [seed](const Vector3f& p) {
      return 0.1f * ValueNoise(20 * p, seed + 1);
    };
    const MeshReport report = Analyze(MeshSolid(solid, 0.1f));
    EXPECT_GT(report.num_facets, 100);
    EXPECT_TRUE(report.IsManifold()) << report.Defects();
  }
}

SceneOptions Small(const std::string& shape) {
  SceneOptions options;
  options.shape = shape;
  options.num_images = 1;
  options.width = 120;
  options.height = 90;
  options.cell_size = 2.5;
  return options;
}

// The surface is manifold, and in one piece with one border.
MeshReport ExpectOnePiece(const SceneOptions& options) {
  const MeshReport report = Analyze(MakeScene(options).surface);
  EXPECT_TRUE(report.IsManifold()) << report.Defects();
  EXPECT_EQ(report.num_components, 1);
  EXPECT_EQ(report.num_border_loops, 1);
  return report;
}

TEST(MakeScene, StatueHasOneHandleAndTheWallIsOnePieceWithABorder) {
  EXPECT_EQ(ExpectOnePiece(Small("statue")).genus, 1);
  ExpectOnePiece(Small("wall"));
}

TEST(MakeScene, GridIsOnePieceWithAHandleForEachLoopOfItsRods) {
  SceneOptions options = Small("grid");
  options.thickness = 3;  // as the cells are large
  options.cell_size = 2;
  // Six meshes of the lattice; four posts, the first of which closes none; the
  // gable.
  EXPECT_EQ(ExpectOnePiece(options).genus, 6 + 3 + 1);
}

TEST(MakeScene, RefusesOtherShapes) {
  EXPECT_THROW(MakeScene(Small("teapot")), std::invalid_argument);
}

}  // namespace colmap_ext::synthetic::isosurface_test
