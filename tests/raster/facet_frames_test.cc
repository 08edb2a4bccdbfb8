#include "raster/facet_frames.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "tests/mesh/known_meshes.h"

namespace colmap_ext {
namespace facet_frames_test {

using Eigen::Vector3d;
using Eigen::Vector3f;

Vector3d Corner(const TriangleMesh& mesh, size_t facet, int k) {
  return mesh.vertices[mesh.facets[facet][k]].cast<double>();
}

TEST(FacetFrames, HaveUnitNormalsToFreeSpace) {
  Random random(1);
  const TriangleMesh mesh = RandomSoup(20, 60, true, &random);
  const std::vector<FacetFrame> frames = ComputeFacetFrames(mesh);
  ASSERT_EQ(frames.size(), mesh.facets.size());
  for (size_t i = 0; i < frames.size(); ++i) {
    const Vector3d edge_1 = Corner(mesh, i, 1) - Corner(mesh, i, 0);
    const Vector3d edge_2 = Corner(mesh, i, 2) - Corner(mesh, i, 0);
    EXPECT_EQ(frames[i].corner, Corner(mesh, i, 0));
    EXPECT_NEAR(frames[i].normal.norm(), 1, 1e-12);
    EXPECT_NEAR(frames[i].normal.dot(edge_1), 0, 1e-12);
    EXPECT_NEAR(frames[i].normal.dot(edge_2), 0, 1e-12);
    EXPECT_GT(frames[i].normal.dot(edge_1.cross(edge_2)), 0);
  }
  const FacetFrame up =
      ComputeFacetFrame({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {}}, {0, 1, 2});
  EXPECT_EQ(up.normal, Vector3d::UnitZ());
}

// Points are sums of the corners by their barycentric coordinates; what lies
// off the plane has those of its foot.
TEST(FacetFrames, TellBarycentricCoordinates) {
  Random random(2);
  const TriangleMesh mesh = RandomSoup(20, 60, true, &random);
  const std::vector<FacetFrame> frames = ComputeFacetFrames(mesh);
  for (size_t i = 0; i < frames.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      EXPECT_LT((frames[i].Barycentric(Corner(mesh, i, k)) - Vector3d::Unit(k))
                    .norm(),
                1e-9);
    }
    for (int trial = 0; trial < 5; ++trial) {
      const double b = 3 * random.Unit() - 1;
      const double c = 3 * random.Unit() - 1;
      const Vector3d weights(1 - b - c, b, c);
      Vector3d point = random.Unit() * frames[i].normal;
      for (int k = 0; k < 3; ++k) {
        point += weights[k] * Corner(mesh, i, k);
      }
      EXPECT_LT((frames[i].Barycentric(point) - weights).norm(), 1e-8);
    }
  }
}

TEST(FacetFrames, OfDegenerateFacetsAreZero) {
  const TriangleMesh line = {{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}, {{0, 1, 2}}};
  const FacetFrame frame = ComputeFacetFrames(line).front();
  EXPECT_EQ(frame.normal, Vector3d::Zero());
  EXPECT_EQ(frame.Barycentric({3, 4, 5}), Vector3d::UnitX());
  EXPECT_TRUE(ComputeFacetFrames(TriangleMesh()).empty());
}

TEST(FacetFrames, ScaleWithTheScene) {
  const TriangleMesh cube = MakeCube();
  TriangleMesh large = cube;
  for (Vector3f& vertex : large.vertices) {
    vertex *= 1024;
  }
  const std::vector<FacetFrame> frames = ComputeFacetFrames(cube);
  const std::vector<FacetFrame> scaled = ComputeFacetFrames(large);
  for (size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(scaled[i].normal, frames[i].normal);
    EXPECT_EQ(1024 * scaled[i].gradient_1, frames[i].gradient_1);
    EXPECT_EQ(1024 * scaled[i].gradient_2, frames[i].gradient_2);
  }
}

}  // namespace facet_frames_test
}  // namespace colmap_ext
