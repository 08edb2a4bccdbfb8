#include "mesh/subdivision.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "tests/mesh/known_meshes.h"
#include "tests/mesh/manifold_links.h"
#include "tests/remesh/remeshed.h"
#include "tests/threads.h"

namespace colmap_ext::subdivision_test {

using Eigen::Vector3d;

Vector3d AreaOf(const TriangleMesh& mesh, const Facet& facet) {
  const auto [a, b, c] = CornersOf<double>(mesh, facet);
  return (b - a).cross(c - a) / 2;
}

std::vector<uint8_t> RandomFlags(size_t size, double share, Random* random) {
  std::vector<uint8_t> flags(size);
  for (uint8_t& flag : flags) {
    flag = random->Chance(share);
  }
  return flags;
}

// The parts of a facet have its area together, and its direction each.
void ExpectPartsOfFacets(const TriangleMesh& mesh,
                         const std::vector<uint8_t>& is_to_split,
                         const DerivedMesh& result) {
  ASSERT_EQ(result.from.facets.size(), result.mesh.facets.size());
  EXPECT_TRUE(std::ranges::is_sorted(result.from.facets));
  std::vector<double> areas(mesh.facets.size(), 0);
  std::vector<int> num_parts(mesh.facets.size(), 0);
  for (size_t i = 0; i < result.from.facets.size(); ++i) {
    const uint32_t source = result.from.facets[i];
    const Vector3d whole = AreaOf(mesh, mesh.facets[source]);
    const Vector3d part = AreaOf(result.mesh, result.mesh.facets[i]);
    EXPECT_NEAR(part.dot(whole), part.norm() * whole.norm(),
                1e-5 * whole.squaredNorm() + 1e-12);
    areas[source] += part.norm();
    ++num_parts[source];
  }
  for (size_t i = 0; i < mesh.facets.size(); ++i) {
    const double area = AreaOf(mesh, mesh.facets[i]).norm();
    EXPECT_NEAR(areas[i], area, 1e-4 * area + 1e-7);
    EXPECT_GE(num_parts[i], 1);
    EXPECT_LE(num_parts[i], 4);
    EXPECT_TRUE(!is_to_split[i] || num_parts[i] == 4);
  }
}

void ExpectSources(const TriangleMesh& mesh, const DerivedMesh& result) {
  ASSERT_EQ(result.from.vertices.size(), result.mesh.vertices.size());
  for (uint32_t i = 0; i < result.from.vertices.size(); ++i) {
    const auto [a, b] = result.from.vertices[i];
    EXPECT_EQ(a == b, i < mesh.vertices.size());
    EXPECT_TRUE(a != b || a == i);
    EXPECT_EQ(result.mesh.vertices[i],
              0.5f * (mesh.vertices[a] + mesh.vertices[b]));
  }
}

void ExpectGood(const TriangleMesh& mesh,
                const std::vector<uint8_t>& is_to_split) {
  const DerivedMesh result = Subdivide(mesh, is_to_split);
  ExpectPartsOfFacets(mesh, is_to_split, result);
  ExpectSources(mesh, result);
  ExpectSameTopology(mesh, result.mesh);
}

std::vector<TriangleMesh> Shapes() {
  Random random(1);
  return {MakeTetrahedron(),     MakeCube(),
          MakeTorus(),           MakeDisc(),
          MakeAnnulus(),         Union(MakeTorus(), MakeCube()),
          MakeBumpySphere(0.2f), MakeBumpyCap(0.2f),
          MakeRoundTorus(0.2f),  MakeJitteredSquare(12, &random)};
}

TEST(Subdivide, KeepsTheSurfaceAndItsTopology) {
  Random random(2);
  for (const TriangleMesh& mesh : Shapes()) {
    for (const double share : {0.01, 0.1, 0.5, 0.9, 1.0}) {
      ExpectGood(mesh, RandomFlags(mesh.facets.size(), share, &random));
    }
  }
}

TEST(Subdivide, KeepsTheTopologyOfRandomMeshes) {
  Random random(3);
  for (int trial = 0; trial < 1000; ++trial) {
    const TriangleMesh mesh = MakeRandomManifold(&random);
    ExpectGood(mesh, RandomFlags(mesh.facets.size(), random.Unit(), &random));
    ASSERT_FALSE(HasFailure());
  }
}

TEST(Subdivide, OfAllFacetsMakesFourOfEachAndOfNoneChangesNothing) {
  std::vector<TriangleMesh> meshes = Shapes();
  meshes.emplace_back();
  for (const TriangleMesh& mesh : meshes) {
    const MeshReport before = Analyze(mesh);
    std::vector<uint8_t> flags(mesh.facets.size(), 1);
    const MeshReport after = Analyze(Subdivide(mesh, flags).mesh);
    EXPECT_EQ(after.num_facets, 4 * before.num_facets);
    EXPECT_EQ(after.num_vertices, before.num_vertices + before.num_edges);
    EXPECT_EQ(after.num_border_edges, 2 * before.num_border_edges);
    flags.assign(mesh.facets.size(), 0);
    EXPECT_EQ(Subdivide(mesh, flags).mesh, mesh);
  }
}

// One facet of a sheet of quads, all of whose longest edges are the diagonals.
TEST(Subdivide, OfOneFacetCutsFewOthers) {
  const TriangleMesh mesh = MakeDisc();
  std::vector<uint8_t> flags(mesh.facets.size(), 0);
  flags[2 * (2 * 7 + 3)] = 1;  // an inner quad's
  const DerivedMesh result = Subdivide(mesh, flags);
  // The two at its other edges are cut in three, across their diagonals one
  // each in two.
  EXPECT_EQ(result.mesh.vertices.size(), mesh.vertices.size() + 3 + 2);
  EXPECT_EQ(result.mesh.facets.size(), mesh.facets.size() + 3 + 1 + 2 * 3);
  EXPECT_EQ(Analyze(result.mesh).num_border_edges,
            Analyze(mesh).num_border_edges);
}

// Of the two diagonals of what is left of a facet cut at two edges.
TEST(Subdivide, TakesTheShorterDiagonal) {
  // Beside the first facet, at its longest edge 0 1 and its shortest 1 2.
  const TriangleMesh mesh = {
      {{0, 0, 0}, {4, 0, 0}, {3, 2, 0}, {2, -3, 0}, {6, 3, 0}},
      {{0, 1, 2}, {1, 0, 3}, {2, 1, 4}}};
  const DerivedMesh result = Subdivide(mesh, {0, 1, 1});
  // From the middle of 1 2 (3.5, 1) to 0 is farther than from the middle of 0 1
  // (2, 0) to 2.
  EXPECT_EQ(result.from.vertices.size(), mesh.vertices.size() + 6);
  const auto middle = [&](uint32_t a, uint32_t b) {
    const auto at = std::ranges::find(result.from.vertices, std::array{a, b});
    return static_cast<uint32_t>(at - result.from.vertices.begin());
  };
  const std::vector<Facet> parts(result.mesh.facets.begin(),
                                 result.mesh.facets.begin() + 3);
  EXPECT_EQ(parts, (std::vector<Facet>{{middle(0, 1), 1, middle(1, 2)},
                                       {0, middle(0, 1), 2},
                                       {middle(0, 1), middle(1, 2), 2}}));
}

TEST(Subdivide, KeepsAnglesFromBecomingEverSharper) {
  TriangleMesh mesh = MakeDisc();
  const double before = std::ranges::min(SmallestAngles(mesh));
  for (int round = 0; round < 12; ++round) {  // towards a point
    std::vector<uint8_t> flags(mesh.facets.size(), 0);
    for (size_t i = 0; i < flags.size(); ++i) {
      const Eigen::Vector3f& vertex = mesh.vertices[mesh.facets[i][0]];
      flags[i] = (vertex - Eigen::Vector3f(3.3f, 2.7f, 0)).norm() <
                 2 * std::pow(0.5f, static_cast<float>(round));
    }
    mesh = Subdivide(mesh, flags).mesh;
  }
  EXPECT_GT(std::ranges::min(SmallestAngles(mesh)), before / 2 - 0.05);
}

TEST(Subdivide, IsTheSameForAnyNumberOfThreads) {
  Random random(6);
  const TriangleMesh mesh = MakeBumpySphere(0.03f);
  const std::vector<uint8_t> flags =
      RandomFlags(mesh.facets.size(), 0.3, &random);
  ExpectSameForAnyThreads([&] { return Subdivide(mesh, flags); });
}

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

}  // namespace colmap_ext::subdivision_test
