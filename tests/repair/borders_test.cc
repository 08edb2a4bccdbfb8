#include "repair/borders.h"

#include <algorithm>
#include <span>
#include <stdexcept>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "mesh/split_fans.h"
#include "mesh/topology.h"
#include "spatial/self_intersections.h"
#include "tests/mesh/known_meshes.h"
#include "tests/threads.h"

namespace colmap_ext::borders_test {

class EditBordersTest : public testing::Test {
 protected:
  EditBordersTest() {
    attributes_.views = Rows<uint32_t>(mesh_.vertices.size());
    for (uint32_t i = 0; i < mesh_.vertices.size(); ++i) {
      attributes_.confidences.push_back(static_cast<float>(i % 7) / 7);
    }
    for (const Facet& facet : mesh_.facets) {
      confidences_.push_back(mesh_.vertices[facet[0]].z() < 0.7f ? 1.0f : 0.0f);
    }
  }

  struct Edited : Surface {
    Provenance from;
    BorderReport report;
  };

  Edited Edit(double trim, double close_holes) {
    Edited edited{{mesh_, attributes_}, {}, {}};
    edited.from = TrimAndCloseHoles({trim, close_holes}, confidences_, {},
                                    &edited, &edited.report);
    return edited;
  }

  const TriangleMesh mesh_ = MakeBumpySphere(0.15f);
  VertexAttributes attributes_;
  std::vector<float> confidences_;
};

TEST_F(EditBordersTest, LeavesTheMeshByDefault) {
  const Edited edited = Edit(0, 0);
  EXPECT_EQ(edited.mesh, mesh_);
  EXPECT_EQ(edited.attributes.confidences, attributes_.confidences);
}

TEST_F(EditBordersTest, ClosesWhatItHasTrimmed) {
  const Edited edited = Edit(0.5, kAllLoops);
  const MeshReport report = Analyze(edited.mesh);
  EXPECT_EQ(report.Defects(), "");
  EXPECT_EQ(report.euler, 2);
  EXPECT_EQ(edited.report.holes.num_closed, 1);
}

TEST_F(EditBordersTest, SaysWhereEachVertexAndFacetComesFrom) {
  const Edited edited = Edit(0.5, kAllLoops);
  size_t num_new = 0;
  ASSERT_EQ(edited.from.vertices.size(), edited.mesh.vertices.size());
  for (size_t i = 0; i < edited.from.vertices.size(); ++i) {
    const uint32_t source = edited.from.vertices[i][0];
    num_new += source == kNone;
    EXPECT_EQ(edited.attributes.confidences[i],
              source == kNone ? 0 : attributes_.confidences[source]);
  }
  EXPECT_EQ(num_new, edited.report.holes.num_vertices);
  ASSERT_EQ(edited.from.facets.size(), edited.mesh.facets.size());
  for (size_t i = 0; i < edited.from.facets.size(); ++i) {
    const uint32_t source = edited.from.facets[i];
    for (int k = 0; k < 3 && source != kNone; ++k) {
      EXPECT_EQ(edited.from.vertices[edited.mesh.facets[i][k]][0],
                mesh_.facets[source][k]);
    }
  }
}

TEST_F(EditBordersTest, RefusesToLeaveNothing) {
  confidences_.assign(mesh_.facets.size(), 0);
  EXPECT_THROW(Edit(0.5, 0), std::invalid_argument);
}

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

struct Closed : Surface {
  HoleReport report;
};

// What was there stays; what is new is known to be.
Closed Close(double max_width, const TriangleMesh& mesh,
             float footprint = 0.01f) {
  Closed closed{{mesh, {}, mesh.vertices}, {}};
  VertexAttributes& attributes = closed.attributes;
  for (size_t i = 0; i < mesh.vertices.size(); ++i) {
    attributes.colors.push_back({10, static_cast<uint8_t>(100 + i % 3), 200});
    attributes.confidences.push_back(0.5f);
    attributes.views.AddRow(std::vector<uint32_t>{1, 2});
  }
  closed.report = CloseHoles(
      max_width, std::vector<float>(mesh.vertices.size(), footprint), &closed);
  EXPECT_EQ(closed.origins, closed.mesh.vertices);
  EXPECT_EQ(Analyze(closed.mesh).Defects(), "");
  const size_t num_vertices = mesh.vertices.size();
  const size_t num_facets = mesh.facets.size();
  EXPECT_EQ(closed.mesh.vertices.size(),
            num_vertices + closed.report.num_vertices);
  EXPECT_EQ(closed.mesh.facets.size(), num_facets + closed.report.num_facets);
  EXPECT_TRUE(std::ranges::equal(
      mesh.vertices, std::span(closed.mesh.vertices).first(num_vertices)));
  EXPECT_TRUE(std::ranges::equal(
      mesh.facets, std::span(closed.mesh.facets).first(num_facets)));
  EXPECT_EQ(attributes.colors.size(), closed.mesh.vertices.size());
  EXPECT_EQ(attributes.confidences.size(), closed.mesh.vertices.size());
  EXPECT_EQ(attributes.views.size(), closed.mesh.vertices.size());
  for (size_t i = num_vertices; i < closed.mesh.vertices.size(); ++i) {
    EXPECT_EQ(attributes.confidences[i], 0);
    EXPECT_TRUE(attributes.views[i].empty());
    EXPECT_EQ(attributes.colors[i][0], 10);
    EXPECT_GE(attributes.colors[i][1], 100);
    EXPECT_LE(attributes.colors[i][1], 102);
  }
  return closed;
}

TEST(CloseHoles, ASphereWithHolesIsASphereAgain) {
  const TriangleMesh mesh = HoledSphere(kSixSides, 0.4f);
  ASSERT_EQ(Analyze(mesh).num_border_loops, 6);
  ASSERT_TRUE(Analyze(mesh).IsManifold());
  const Closed closed = Close(kAllLoops, mesh);
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

TEST(CloseHoles, ClosesThoseUpToAWidthInPixels) {
  // About 0.6 to 0.9 wide: 0.3 around a point, and the facets there.
  const TriangleMesh mesh = HoledSphere({kSixSides[0]}, 0.3f);
  for (const double max_width : {0.0, 1.0, 50.0}) {
    const Closed closed = Close(max_width, mesh);
    EXPECT_EQ(closed.mesh.facets, mesh.facets);
    EXPECT_EQ(closed.report.num_loops, 0);
  }
  EXPECT_EQ(Close(100, mesh).report.num_closed, 1);
  EXPECT_EQ(Close(50, mesh, 0.02f).report.num_closed, 1);
}

// A square of 1 x 1 in small facets, without those whose middle is in a box.
TriangleMesh SquareWithout(const Eigen::AlignedBox2f& box) {
  Random random(1);
  TriangleMesh mesh = MakeJitteredSquare(40, &random);
  std::erase_if(mesh.facets, [&](const Facet& facet) {
    return box.contains(CentroidOf(mesh, facet).head<2>());
  });
  return SplitFans(mesh).mesh;
}

TEST(CloseHoles, LongSlitsAreAsWideAsTheyAreAcross) {
  const TriangleMesh slit = SquareWithout(
      {Eigen::Vector2f(0.1f, 0.5f), Eigen::Vector2f(0.9f, 0.56f)});
  ASSERT_EQ(Analyze(slit).num_border_loops, 2);
  const Closed closed = Close(25, slit);
  EXPECT_EQ(closed.report.num_closed, 1);
  EXPECT_EQ(Analyze(closed.mesh).num_border_loops, 1);
  const TriangleMesh hole =
      SquareWithout({Eigen::Vector2f(0.3f, 0.3f), Eigen::Vector2f(0.7f, 0.7f)});
  EXPECT_EQ(Close(25, hole).report.num_loops, 0);
  EXPECT_EQ(Close(80, hole).report.num_closed, 1);
}

TEST(CloseHoles, MayIntersectWhatStandsInAHole) {
  const TriangleMesh hole =
      SquareWithout({Eigen::Vector2f(0.3f, 0.3f), Eigen::Vector2f(0.7f, 0.7f)});
  const TriangleMesh post = {
      {{0.5f, 0.5f, -0.3f}, {0.52f, 0.5f, 0.3f}, {0.5f, 0.52f, 0.3f}},
      {{0, 1, 2}}};
  const Closed closed = Close(80, Union(hole, post));
  EXPECT_EQ(closed.report.num_closed, 1);
  EXPECT_EQ(closed.report.num_intersecting, 1);
  EXPECT_GT(FindSelfIntersections(closed.mesh).size(), 0);
}

TEST(CloseHoles, LeavesOuterBordersAndClosedMeshes) {
  const TriangleMesh strip =
      SquareWithout({Eigen::Vector2f(0, 0.2f), Eigen::Vector2f(1, 1)});
  for (const double max_width : {40.0, 1000.0}) {
    EXPECT_EQ(Close(max_width, strip).report.num_loops, 0);
  }
  const TriangleMesh torus = MakeRoundTorus(0.2f);
  EXPECT_EQ(Close(kAllLoops, torus).mesh.facets, torus.facets);
  const TriangleMesh facet = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  EXPECT_EQ(Close(kAllLoops, facet).report.num_loops, 1);
}

TEST(CloseHoles, GoesWithoutColoursAndConfidences) {
  const TriangleMesh mesh = HoledSphere(kSixSides, 0.4f);
  Surface closed{mesh, {{}, Rows<uint32_t>(mesh.vertices.size())}};
  CloseHoles(kAllLoops, {}, &closed);
  EXPECT_TRUE(closed.attributes.colors.empty());
  EXPECT_TRUE(closed.attributes.confidences.empty());
  EXPECT_EQ(closed.attributes.views.size(), closed.mesh.vertices.size());
}

TEST(CloseHoles, StaysManifoldWhateverItGets) {
  Random random(1);
  for (int trial = 0; trial < 40; ++trial) {
    TriangleMesh mesh = MakeRandomManifold(&random);
    std::erase_if(mesh.facets,
                  [&](const Facet&) { return random.Unit() < 0.2; });
    mesh = SplitFans(mesh).mesh;
    const Closed closed = Close(kAllLoops, mesh);
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

}  // namespace colmap_ext::borders_test
