#include "mesh/edge_collapse.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <Eigen/Geometry>

#include "mesh/half_edges.h"
#include "mesh/singular_vertices.h"
#include "mesh/subdivision.h"
#include "mesh/topology.h"
#include "tests/mesh/known_meshes.h"
#include "tests/mesh/manifold_links.h"
#include "tests/mesh/shapes.h"

namespace colmap_ext {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

EdgeCollapse Collapse(const TriangleMesh& mesh, float target) {
  return CollapseShortEdges(mesh,
                            std::vector<float>(mesh.vertices.size(), target));
}

Vector3d AreaVector(const TriangleMesh& mesh, const Facet& facet) {
  const Vector3d a = mesh.vertices[facet[0]].cast<double>();
  const Vector3d b = mesh.vertices[facet[1]].cast<double>();
  const Vector3d c = mesh.vertices[facet[2]].cast<double>();
  return (b - a).cross(c - a) / 2;
}

double Area(const TriangleMesh& mesh) {
  double area = 0;
  for (const Facet& facet : mesh.facets) {
    area += AreaVector(mesh, facet).norm();
  }
  return area;
}

double Volume(const TriangleMesh& mesh) {
  double volume = 0;
  for (const auto& [a, b, c] : mesh.facets) {
    volume += mesh.vertices[a].cast<double>().dot(
                  mesh.vertices[b].cast<double>().cross(
                      mesh.vertices[c].cast<double>())) /
              6;
  }
  return volume;
}

// The area within the border, seen along z.
double AreaOfBorder(const TriangleMesh& mesh) {
  double area = 0;
  for (const Facet& facet : mesh.facets) {
    area += AreaVector(mesh, facet).z();
  }
  return area;
}

TriangleMesh Subdivided(TriangleMesh mesh, int num_rounds) {
  for (int round = 0; round < num_rounds; ++round) {
    mesh = Subdivide(mesh, std::vector<uint8_t>(mesh.facets.size(), 1)).mesh;
  }
  return mesh;
}

void ExpectSameTopology(const TriangleMesh& mesh, const TriangleMesh& result) {
  const MeshReport before = Analyze(mesh);
  const MeshReport after = Analyze(result);
  EXPECT_TRUE(after.IsManifold()) << after.Defects();
  EXPECT_TRUE(HasManifoldLinks(result));
  EXPECT_EQ(after.euler, before.euler);
  EXPECT_EQ(after.genus, before.genus);
  EXPECT_EQ(after.num_components, before.num_components);
  EXPECT_EQ(after.num_border_loops, before.num_border_loops);
}

template <typename T>
bool IsAscendingBelow(const std::vector<T>& values, size_t limit) {
  return std::adjacent_find(values.begin(), values.end(),
                            std::greater_equal<>()) == values.end() &&
         (values.empty() || values.back() < limit);
}

size_t MostNeighbors(const TriangleMesh& mesh) {
  std::vector<std::set<uint32_t>> neighbors(mesh.vertices.size());
  size_t most = 0;
  for (const Facet& facet : mesh.facets) {
    for (const uint32_t vertex : facet) {
      neighbors[vertex].insert(facet.begin(), facet.end());
      most = std::max(most, neighbors[vertex].size() - 1);
    }
  }
  return most;
}

std::vector<Vector3f> BorderVertices(const TriangleMesh& mesh) {
  const std::vector<uint32_t> partners = PairHalfEdges(mesh.facets);
  std::vector<Vector3f> vertices;
  for (uint32_t half = 0; half < partners.size(); ++half) {
    if (partners[half] == kNoPartner) {
      vertices.push_back(mesh.vertices[FromVertex(mesh.facets, half)]);
    }
  }
  return vertices;
}

float LongestEdge(const TriangleMesh& mesh) {
  float longest = 0;
  for (const Facet& facet : mesh.facets) {
    for (int k = 0; k < 3; ++k) {
      longest = std::max(
          longest,
          (mesh.vertices[facet[k]] - mesh.vertices[facet[(k + 1) % 3]]).norm());
    }
  }
  return longest;
}

// What holds whatever the mesh and the targets are.
void ExpectGood(const TriangleMesh& mesh, const std::vector<float>& targets,
                const EdgeCollapse& result) {
  ExpectSameTopology(mesh, result.mesh);
  ASSERT_EQ(result.sources.size(), result.mesh.vertices.size());
  ASSERT_EQ(result.facet_sources.size(), result.mesh.facets.size());
  EXPECT_TRUE(IsAscendingBelow(result.sources, mesh.vertices.size()));
  EXPECT_TRUE(IsAscendingBelow(result.facet_sources, mesh.facets.size()));
  EXPECT_LE(MostNeighbors(result.mesh),
            std::max<size_t>(12, MostNeighbors(mesh)));
  // Where targets differ they may pass to vertices whose edges have grown.
  const float largest =
      targets.empty() ? 0 : *std::max_element(targets.begin(), targets.end());
  EXPECT_LE(LongestEdge(result.mesh),
            1.0001f * std::max(LongestEdge(mesh), 1.5f * largest));
}

void ExpectUnchanged(const TriangleMesh& mesh, const EdgeCollapse& result) {
  EXPECT_EQ(result.mesh.vertices, mesh.vertices);
  EXPECT_EQ(result.mesh.facets, mesh.facets);
}

TEST(CollapseShortEdges, KeepsTheTopology) {
  Random random(1);
  for (const TriangleMesh& mesh :
       {MakeBumpySphere(0.15f), MakeBumpyCap(0.15f), MakeRoundTorus(0.15f),
        MakeFineCube(0.2f), MakeJitteredSquare(20, &random),
        Subdivided(MakeCube(), 3),
        Union(MakeRoundTorus(0.2f), MakeBumpyCap(0.2f))}) {
    for (const float target : {0.05f, 0.1f, 0.2f, 0.5f, 2.0f, 1000.0f}) {
      const EdgeCollapse result = Collapse(mesh, target);
      ExpectGood(mesh, std::vector<float>(mesh.vertices.size(), target),
                 result);
      if (target == 2) {
        EXPECT_LT(result.mesh.facets.size(), mesh.facets.size() / 10);
      }
    }
  }
}

TEST(CollapseShortEdges, KeepsTheTopologyOfRandomMeshes) {
  Random random(2);
  size_t num_collapsed = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    const TriangleMesh mesh =
        Subdivided(MakeRandomManifold(&random), trial % 3);
    std::vector<float> targets(mesh.vertices.size());
    for (float& target : targets) {
      target = static_cast<float>(random.Unit());
    }
    const EdgeCollapse result = CollapseShortEdges(mesh, targets);
    ExpectGood(mesh, targets, result);
    num_collapsed += mesh.vertices.size() - result.mesh.vertices.size();
    ASSERT_FALSE(HasFailure());
  }
  EXPECT_GT(num_collapsed, 10000u);
}

TEST(CollapseShortEdges, LeavesTheSmallestMeshesOfTheirKinds) {
  const TriangleMesh facet = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  for (const TriangleMesh& mesh : {TriangleMesh(), facet, MakeTetrahedron()}) {
    ExpectUnchanged(mesh, Collapse(mesh, 100));
    const EdgeCollapse result = Collapse(Subdivided(mesh, 3), 100);
    EXPECT_EQ(result.mesh.facets.size(), mesh.facets.size());
  }
}

TEST(CollapseShortEdges, LeavesWhatIsLongEnough) {
  const TriangleMesh mesh = MakeBumpyCap(0.2f);
  for (const float target :
       {0.0f, -1.0f, 1e-5f, std::numeric_limits<float>::quiet_NaN()}) {
    const EdgeCollapse result = Collapse(mesh, target);
    ExpectUnchanged(mesh, result);
    EXPECT_EQ(result.sources.size(), mesh.vertices.size());
  }
}

TEST(CollapseShortEdges, GoesByTheTargetsOfTheVertices) {
  const TriangleMesh mesh = MakeBumpySphere(0.1f);
  std::vector<float> targets;
  for (const Vector3f& vertex : mesh.vertices) {
    targets.push_back(vertex.z() > 0 ? 0.3f : 0.0f);
  }
  const EdgeCollapse result = CollapseShortEdges(mesh, targets);
  ExpectGood(mesh, targets, result);
  size_t num_below = 0;
  for (size_t i = 0; i < result.sources.size(); ++i) {
    const Vector3f& source = mesh.vertices[result.sources[i]];
    if (source.z() <= 0) {
      EXPECT_EQ(result.mesh.vertices[i], source);
      ++num_below;
    }
  }
  EXPECT_EQ(num_below, std::count(targets.begin(), targets.end(), 0.0f));
  EXPECT_LT(result.sources.size() - num_below,
            (mesh.vertices.size() - num_below) / 8);
}

TEST(CollapseShortEdges, KeepsTheShapeOfASphere) {
  const TriangleMesh mesh = MakeBumpySphere(0.03f);
  const EdgeCollapse result = Collapse(mesh, 0.06f);
  EXPECT_LT(result.mesh.facets.size(), mesh.facets.size() / 6);
  EXPECT_NEAR(Volume(result.mesh), Volume(mesh), 1e-3 * Volume(mesh));
  EXPECT_NEAR(Area(result.mesh), Area(mesh), 3e-3 * Area(mesh));
  for (size_t i = 0; i < result.mesh.facets.size(); ++i) {
    const Facet& source = mesh.facets[result.facet_sources[i]];
    EXPECT_GT(AreaVector(result.mesh, result.mesh.facets[i])
                  .dot(AreaVector(mesh, source)),
              0);
  }
  for (size_t i = 0; i < result.sources.size(); ++i) {
    EXPECT_LT(
        (result.mesh.vertices[i] - mesh.vertices[result.sources[i]]).norm(),
        2 * 0.06f);
  }
}

TEST(CollapseShortEdges, KeepsTheEdgesAndCornersOfACube) {
  const TriangleMesh mesh = Subdivided(MakeCube(), 5);
  for (const float target : {0.1f, 0.3f}) {
    const TriangleMesh result = Collapse(mesh, target).mesh;
    EXPECT_NEAR(Volume(result), 1, 2e-3);
    EXPECT_NEAR(Area(result), 6, 6e-3);
    for (const Vector3f& corner : MakeCube().vertices) {
      float nearest = 1;
      for (const Vector3f& vertex : result.vertices) {
        nearest = std::min(nearest, (vertex - corner).norm());
      }
      EXPECT_LT(nearest, 0.01f * target);
    }
  }
}

TEST(CollapseShortEdges, KeepsAStraightBorderWhereItIs) {
  Random random(4);
  const TriangleMesh mesh = MakeJitteredSquare(40, &random);
  for (const float target : {0.05f, 0.1f, 0.3f}) {
    const TriangleMesh result = Collapse(mesh, target).mesh;
    EXPECT_NEAR(AreaOfBorder(result), 1, 1e-3);
    EXPECT_NEAR(Area(result), AreaOfBorder(result), 1e-6);  // none flips
    for (const Vector3f& vertex : result.vertices) {
      EXPECT_NEAR(vertex.z(), 0, 1e-6);
    }
    for (const Vector3f& vertex : BorderVertices(result)) {
      EXPECT_NEAR((vertex - Vector3f(0.5f, 0.5f, 0)).cwiseAbs().maxCoeff(),
                  0.5f, 0.003f * target);
    }
  }
}

TEST(CollapseShortEdges, DoesNotLetARoundBorderShrink) {
  const TriangleMesh mesh = MakeBumpyCap(0.05f, 0);
  const double before = AreaOfBorder(mesh);
  for (const float target : {0.1f, 0.2f}) {
    const TriangleMesh result = Collapse(mesh, target).mesh;
    EXPECT_GT(AreaOfBorder(result), (1 - 0.25 * target * target) * before);
    for (const Vector3f& vertex : BorderVertices(result)) {
      EXPECT_NEAR(vertex.z(), -0.3f, 0.1f * target * target);
    }
  }
}

TEST(CollapseShortEdges, DoesNotMakeSlivers) {
  Random random(5);
  for (const TriangleMesh& mesh :
       {MakeJitteredSquare(40, &random), MakeRoundTorus(0.05f)}) {
    const TriangleMesh result = Collapse(mesh, 0.1f).mesh;
    for (const auto& [a, b, c] : result.facets) {
      const Vector3f u = result.vertices[b] - result.vertices[a];
      const Vector3f v = result.vertices[c] - result.vertices[b];
      const Vector3f w = result.vertices[a] - result.vertices[c];
      EXPECT_GT(u.cross(v).norm(),
                0.0999f * std::max({u.squaredNorm(), v.squaredNorm(),
                                    w.squaredNorm()}));
    }
  }
}

TEST(CollapseShortEdges, ScalesWithTheScene) {
  TriangleMesh mesh = MakeBumpyCap(0.1f);
  const EdgeCollapse expected = Collapse(mesh, 0.2f);
  for (Vector3f& vertex : mesh.vertices) {
    vertex *= 1024;
  }
  const EdgeCollapse result = Collapse(mesh, 1024 * 0.2f);
  EXPECT_EQ(result.mesh.facets, expected.mesh.facets);
  EXPECT_EQ(result.sources, expected.sources);
  for (size_t i = 0; i < expected.mesh.vertices.size(); ++i) {
    EXPECT_EQ(result.mesh.vertices[i], 1024 * expected.mesh.vertices[i]);
  }
}

TEST(CollapseShortEdges, IsTheSameForAnyNumberOfThreads) {
  const TriangleMesh mesh = MakeBumpySphere(0.05f);
  const EdgeCollapse expected = Collapse(mesh, 0.1f);
  for (const size_t num_threads : {1, 2, 7}) {
    const tbb::global_control control(
        tbb::global_control::max_allowed_parallelism, num_threads);
    const EdgeCollapse result = Collapse(mesh, 0.1f);
    EXPECT_EQ(result.mesh.vertices, expected.mesh.vertices);
    EXPECT_EQ(result.mesh.facets, expected.mesh.facets);
    EXPECT_EQ(result.sources, expected.sources);
    EXPECT_EQ(result.facet_sources, expected.facet_sources);
  }
}

}  // namespace
}  // namespace colmap_ext
