#include "repair/edit_borders.h"

#include <algorithm>
#include <span>

#include <gtest/gtest.h>

#include "mesh/manifold_repair.h"
#include "mesh/topology.h"
#include "spatial/self_intersections.h"
#include "tests/mesh/shapes.h"
#include "tests/threads.h"

namespace colmap_ext {
namespace close_holes_test {

// A sphere without the facets around some of its vertices.
TriangleMesh HoledSphere(const std::vector<Eigen::Vector3f>& centers,
                         float radius) {
  TriangleMesh mesh = MakeBumpySphere(0.15f);
  std::erase_if(mesh.facets, [&](const Facet& facet) {
    return std::ranges::any_of(centers, [&](const Eigen::Vector3f& center) {
      return (mesh.vertices[facet[0]] - center).norm() < radius;
    });
  });
  return SplitFans(mesh).mesh;
}

const std::vector<Eigen::Vector3f> kSixSides = {
    {1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};

VertexAttributes MakeAttributes(const TriangleMesh& mesh) {
  VertexAttributes attributes;
  for (size_t i = 0; i < mesh.vertices.size(); ++i) {
    attributes.colors.push_back({10, static_cast<uint8_t>(100 + i % 3), 200});
    attributes.confidences.push_back(0.5f);
    attributes.views.AddRow(std::vector<uint32_t>{1, 2});
  }
  return attributes;
}

struct Closed : Surface {
  HoleReport report;
};

Closed Close(int max_edges, const TriangleMesh& mesh) {
  Closed closed{{mesh, MakeAttributes(mesh), mesh.vertices}, {}};
  closed.report = CloseHoles(max_edges, &closed);
  EXPECT_EQ(closed.origins, closed.mesh.vertices);
  return closed;
}

// What was there stays; what is new is known to be.
void ExpectSound(const TriangleMesh& mesh, const Closed& closed) {
  EXPECT_EQ(Analyze(closed.mesh).Defects(), "");
  const size_t num_vertices = mesh.vertices.size();
  const size_t num_facets = mesh.facets.size();
  ASSERT_EQ(closed.mesh.vertices.size(),
            num_vertices + closed.report.num_vertices);
  ASSERT_EQ(closed.mesh.facets.size(), num_facets + closed.report.num_facets);
  EXPECT_TRUE(std::ranges::equal(
      mesh.vertices, std::span(closed.mesh.vertices).first(num_vertices)));
  EXPECT_TRUE(std::ranges::equal(
      mesh.facets, std::span(closed.mesh.facets).first(num_facets)));
  const VertexAttributes& attributes = closed.attributes;
  ASSERT_EQ(attributes.colors.size(), closed.mesh.vertices.size());
  ASSERT_EQ(attributes.confidences.size(), closed.mesh.vertices.size());
  ASSERT_EQ(attributes.views.size(), closed.mesh.vertices.size());
  for (size_t i = num_vertices; i < closed.mesh.vertices.size(); ++i) {
    EXPECT_EQ(attributes.confidences[i], 0);
    EXPECT_TRUE(attributes.views[i].empty());
    EXPECT_EQ(attributes.colors[i][0], 10);
    EXPECT_GE(attributes.colors[i][1], 100);
    EXPECT_LE(attributes.colors[i][1], 102);
  }
}

TEST(CloseHoles, ASphereWithHolesIsASphereAgain) {
  const TriangleMesh mesh = HoledSphere(kSixSides, 0.4f);
  ASSERT_EQ(Analyze(mesh).num_border_loops, 6);
  ASSERT_TRUE(Analyze(mesh).IsManifold());
  const Closed closed = Close(kAllLoops, mesh);
  ExpectSound(mesh, closed);
  const MeshReport report = Analyze(closed.mesh);
  EXPECT_EQ(report.num_border_edges, 0);
  EXPECT_EQ(report.euler, 2);
  EXPECT_EQ(report.num_components, 1);
  EXPECT_EQ(closed.report.num_closed, 6);
  EXPECT_EQ(closed.report.NumLeft(), 0);
  EXPECT_EQ(closed.report.num_intersecting, 0);
  EXPECT_EQ(FindSelfIntersections(closed.mesh).size(),
            FindSelfIntersections(mesh).size());
  EXPECT_GT(closed.report.num_vertices, 6);
  // New vertices lie about where the sphere was.
  for (size_t i = mesh.vertices.size(); i < closed.mesh.vertices.size(); ++i) {
    EXPECT_NEAR(closed.mesh.vertices[i].norm(), 1, 0.2) << i;
  }
}

TEST(CloseHoles, ClosesNoneThatAreLonger) {
  const TriangleMesh mesh = HoledSphere({kSixSides[0]}, 0.3f);
  const size_t num_edges = Analyze(mesh).num_border_edges;
  for (const int max_edges : {0, 2, static_cast<int>(num_edges) - 1}) {
    const Closed closed = Close(max_edges, mesh);
    EXPECT_EQ(closed.mesh.facets, mesh.facets);
    EXPECT_EQ(closed.report.num_loops, 0);
  }
  EXPECT_EQ(Close(static_cast<int>(num_edges), mesh).report.num_closed, 1);
}

TEST(CloseHoles, LeavesClosedMeshesAsTheyAre) {
  const TriangleMesh mesh = MakeRoundTorus(0.2f);
  EXPECT_EQ(Close(kAllLoops, mesh).mesh.facets, mesh.facets);
}

TEST(CloseHoles, GoesWithoutColoursAndConfidences) {
  const TriangleMesh mesh = HoledSphere(kSixSides, 0.4f);
  Surface closed{mesh, {{}, Rows<uint32_t>(mesh.vertices.size())}};
  CloseHoles(kAllLoops, &closed);
  EXPECT_TRUE(closed.attributes.colors.empty());
  EXPECT_TRUE(closed.attributes.confidences.empty());
  EXPECT_EQ(closed.attributes.views.size(), closed.mesh.vertices.size());
}

TEST(CloseHoles, LeavesTheLoopOfASingleFacet) {
  const TriangleMesh mesh = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  const Closed closed = Close(kAllLoops, mesh);
  ExpectSound(mesh, closed);
  EXPECT_EQ(closed.report.num_loops, 1);
}

TEST(CloseHoles, StaysManifoldWhateverItGets) {
  Random random(1);
  for (int trial = 0; trial < 40; ++trial) {
    TriangleMesh mesh = MakeRandomManifold(&random);
    std::erase_if(mesh.facets,
                  [&](const Facet&) { return random.Unit() < 0.2; });
    mesh = SplitFans(mesh).mesh;
    const Closed closed = Close(kAllLoops, mesh);
    ExpectSound(mesh, closed);
    EXPECT_EQ(Analyze(closed.mesh).num_border_loops, closed.report.NumLeft());
  }
}

TEST(CloseHoles, IsTheSameAtAnyNumberOfThreads) {
  const TriangleMesh mesh = HoledSphere(kSixSides, 0.4f);
  ExpectSameForAnyThreads([&] {
    const Closed closed = Close(kAllLoops, mesh);
    return std::pair(closed.mesh, closed.attributes.colors);
  });
}

}  // namespace close_holes_test
}  // namespace colmap_ext
