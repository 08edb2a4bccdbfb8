#include "refine/vertex_motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <gtest/gtest.h>

#include "mesh/normals.h"
#include "spatial/self_intersections.h"
#include "tests/mesh/known_meshes.h"
#include "tests/threads.h"

namespace colmap_ext::vertex_motion_test {

using Eigen::Vector3f;

MovedMesh Move(const TriangleMesh& mesh, const std::vector<Vector3f>& normals,
               const std::vector<double>& motion) {
  FacetTree tree(mesh);
  return MoveSafely(mesh, MakeVertexRings(mesh), normals, motion, &tree);
}

MovedMesh Move(const TriangleMesh& mesh, const std::vector<double>& motion) {
  return Move(mesh, VertexNormals(mesh, MakeVertexRings(mesh)), motion);
}

// [V] at random.
std::vector<double> RandomMotion(const TriangleMesh& mesh, double low,
                                 double high, Random* random) {
  std::vector<double> motion;
  for (size_t i = 0; i < mesh.vertices.size(); ++i) {
    motion.push_back(low + (high - low) * random->Unit());
  }
  return motion;
}

// What every step promises.
void ExpectSafe(const TriangleMesh& mesh, const MovedMesh& moved) {
  const auto before = FindSelfIntersections(mesh);
  EXPECT_TRUE(std::ranges::includes(before, FindSelfIntersections(moved.mesh)));
  const std::vector<Vector3f> old_normals = FacetNormals(mesh);
  const std::vector<Vector3f> new_normals = FacetNormals(moved.mesh);
  for (size_t i = 0; i < old_normals.size(); ++i) {
    EXPECT_GE(old_normals[i].dot(new_normals[i]),
              0.499f * old_normals[i].squaredNorm());
  }
}

// A sheet of 20 x 20 quads of sides of 1 at a height.
TriangleMesh Sheet(float height) {
  return Shifted(MakeSheet(20, 20), {0, 0, height});
}

// Two sheets, the upper one to go down, the lower one up, by a distance in the
// middle and less towards two sides.
TEST(MoveSafely, KeepsSheetsApart) {
  // Shifted so that no vertices meet vertices.
  const TriangleMesh mesh = Union(Sheet(0), Shifted(Sheet(1), {0.3f, 0.2f, 0}));
  const std::vector<Vector3f> normals(mesh.vertices.size(), Vector3f::UnitZ());
  for (const double distance : {0.4, 0.6, 3.0}) {
    std::vector<double> motion;
    for (const Vector3f& vertex : mesh.vertices) {
      const double share = 1 - 0.1 * std::abs(vertex.x() - 10);
      motion.push_back((vertex.z() == 0 ? distance : -distance) * share);
    }
    const MovedMesh moved = Move(mesh, normals, motion);
    ExpectSafe(mesh, moved);
    EXPECT_TRUE(FindSelfIntersections(moved.mesh).empty());
    EXPECT_EQ(moved.motion != motion, distance > 0.5);
  }
}

TEST(MoveSafely, StopsASpikeAtASheet) {
  TriangleMesh mesh = Union(Sheet(0), Sheet(0.5f));
  std::vector<Vector3f> normals(mesh.vertices.size(), Vector3f::UnitZ());
  std::vector<double> motion(mesh.vertices.size(), 0);
  const size_t middle = 10 * 21 + 10;
  motion[middle] = 0.6;
  const MovedMesh moved = Move(mesh, normals, motion);
  ExpectSafe(mesh, moved);
  EXPECT_EQ(moved.motion[middle], 0.3);
  for (size_t i = 0; i < motion.size(); ++i) {
    if (i != middle) {
      EXPECT_EQ(moved.motion[i], 0);
      EXPECT_EQ(moved.mesh.vertices[i], mesh.vertices[i]);
    }
  }
}

// Pulled through its axis at one place.
TEST(MoveSafely, PinchesNoTube) {
  const TriangleMesh mesh =
      Moved(MakeSheet(40, 12, false, true), [](const Vector3f& at) {
        const float angle = at.x() * std::numbers::pi_v<float> / 6;
        return Vector3f(std::cos(angle), std::sin(angle), 0.25f * at.y());
      });
  const std::vector<Vector3f> normals =
      VertexNormals(mesh, MakeVertexRings(mesh));
  const double inwards = normals[0].dot(mesh.vertices[0]) > 0 ? -1 : 1;
  for (const double depth : {0.5, 0.99, 1.0, 1.3}) {
    std::vector<double> motion;
    for (const Vector3f& vertex : mesh.vertices) {
      const double z = vertex.z() - 5;
      motion.push_back(inwards * depth * std::exp(-z * z));
    }
    ExpectSafe(mesh, Move(mesh, normals, motion));
  }
}

TEST(MoveSafely, IsSafeWhateverTheMotion) {
  Random random(1);
  size_t num_before = 0;
  for (int trial = 0; trial < 60; ++trial) {
    TriangleMesh mesh = trial % 3 == 0   ? MakeRandomManifold(&random)
                        : trial % 3 == 1 ? MakeBumpySphere(0.2f)
                                         : MakeRoundTorus(0.15f);
    if (trial % 3 == 1) {  // two that intersect
      mesh = Union(mesh, Shifted(mesh, {1.4f, 0, 0}));
    }
    num_before += FindSelfIntersections(mesh).size();
    ExpectSafe(mesh, Move(mesh, RandomMotion(mesh, -1, 1, &random)));
  }
  EXPECT_GT(num_before, 0u);
}

TEST(MoveSafely, LeavesSafeMotionsAsTheyAre) {
  Random random(2);
  const TriangleMesh mesh = MakeBumpySphere(0.1f);
  const std::vector<Vector3f> normals =
      VertexNormals(mesh, MakeVertexRings(mesh));
  const std::vector<double> motion = RandomMotion(mesh, 0, 1e-3, &random);
  const MovedMesh moved = Move(mesh, normals, motion);
  EXPECT_EQ(moved.motion, motion);
  for (size_t i = 0; i < motion.size(); ++i) {
    EXPECT_EQ(moved.mesh.vertices[i],
              mesh.vertices[i] + static_cast<float>(motion[i]) * normals[i]);
  }
  const std::vector<double> none(motion.size(), 0);
  EXPECT_EQ(Move(mesh, normals, none).mesh.vertices, mesh.vertices);
}

TEST(MoveSafely, IsTheSameForAnyNumberOfThreads) {
  Random random(3);
  const TriangleMesh mesh = MakeRoundTorus(0.05f);
  const std::vector<double> motion = RandomMotion(mesh, -0.5, 0.5, &random);
  ExpectSameForAnyThreads([&] { return Move(mesh, motion).mesh; });
}

}  // namespace colmap_ext::vertex_motion_test
