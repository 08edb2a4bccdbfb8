#include "mesh/topology.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "mesh/surface.h"
#include "tests/mesh/known_meshes.h"
#include "tests/mesh/manifold_links.h"
#include "tests/texts.h"

namespace colmap_ext::topology_test {

struct KnownMesh {
  const char* name;
  TriangleMesh mesh;
  size_t num_components;
  size_t num_border_edges;
  size_t num_border_loops;
  int64_t euler;
  int64_t genus;
};

std::vector<KnownMesh> KnownManifolds() {
  TriangleMesh torus_with_hole = MakeTorus();
  torus_with_hole.facets.erase(torus_with_hole.facets.begin() + 20);
  return {
      {"triangle", {MakeDisc().vertices, {{0, 1, 9}}}, 1, 3, 1, 1, 0},
      {"tetrahedron", MakeTetrahedron(), 1, 0, 0, 2, 0},
      {"cube", MakeCube(), 1, 0, 0, 2, 0},
      {"torus", MakeTorus(), 1, 0, 0, 0, 1},
      {"torus with a hole", torus_with_hole, 1, 3, 1, -1, 1},
      {"disc", MakeDisc(), 1, 24, 1, 1, 0},
      {"annulus", MakeAnnulus(), 1, 10, 2, 0, 0},
      {"two tori", Union(MakeTorus(), MakeTorus()), 2, 0, 0, 0, 2},
      {"torus, cube and disc",
       Union(MakeTorus(), Union(MakeCube(), MakeDisc())), 3, 24, 1, 3, 1},
  };
}

TEST(Topology, KnownManifolds) {
  for (KnownMesh& known : KnownManifolds()) {
    SCOPED_TRACE(known.name);
    DropUnusedVertices(&known.mesh);
    const MeshReport report = ExpectManifoldMesh(known.mesh);
    EXPECT_EQ(report.num_vertices, known.mesh.vertices.size());
    EXPECT_EQ(report.num_facets, known.mesh.facets.size());
    EXPECT_EQ(2 * report.num_edges,
              3 * report.num_facets + known.num_border_edges);
    EXPECT_EQ(report.num_components, known.num_components);
    EXPECT_EQ(report.num_border_edges, known.num_border_edges);
    EXPECT_EQ(report.num_border_loops, known.num_border_loops);
    EXPECT_EQ(report.euler, known.euler);
    EXPECT_EQ(report.genus, known.genus);
  }
}

TEST(Topology, MoebiusStripIsMisorientedAndNothingIsManifold) {
  const MeshReport report = Analyze(MakeMoebiusStrip());
  EXPECT_FALSE(report.IsManifold());
  EXPECT_EQ(report.num_misoriented_edges, 1u);
  EXPECT_EQ(report.num_border_loops, 1u);
  EXPECT_EQ(report.euler, 0);
  EXPECT_EQ(report.num_singular_vertices, 0u);
  const MeshReport nothing = Analyze(TriangleMesh());
  EXPECT_TRUE(nothing.IsManifold());
  EXPECT_EQ(nothing.num_components, 0u);
}

TEST(Topology, CubesThatShareAVertexOrAnEdge) {
  TriangleMesh mesh = Union(MakeCube(), MakeCube());
  MergeVertices(9, 7, &mesh);
  const MeshReport at_vertex = Analyze(mesh);
  EXPECT_EQ(at_vertex.num_components, 2u);
  EXPECT_EQ(at_vertex.Defects(), "1 singular vertices");
  MergeVertices(8, 6, &mesh);  // the second's edge 0 - 1 is the first's 6 - 7
  const MeshReport report = Analyze(mesh);
  EXPECT_EQ(report.num_components, 1u);
  EXPECT_EQ(report.num_non_manifold_edges, 1u);
  EXPECT_EQ(report.num_singular_vertices, 2u);
  EXPECT_FALSE(report.IsManifold());
}

// How the report counts and calls a defect.
struct Defect {
  size_t MeshReport::*count;
  const char* words;
};
constexpr Defect kNonFinite = {&MeshReport::num_non_finite_vertices,
                               "vertices that are not finite"};
constexpr Defect kUnreferenced = {&MeshReport::num_unreferenced_vertices,
                                  "vertices without a facet"};
constexpr Defect kInvalid = {&MeshReport::num_invalid_facets,
                             "facets with an index out of range"};
constexpr Defect kDegenerate = {&MeshReport::num_degenerate_facets,
                                "facets that repeat a vertex"};
constexpr Defect kDuplicate = {&MeshReport::num_duplicate_facets,
                               "facets that are there twice"};
constexpr Defect kNonManifold = {&MeshReport::num_non_manifold_edges,
                                 "edges with more than two facets"};
constexpr Defect kMisoriented = {&MeshReport::num_misoriented_edges,
                                 "edges run twice in one direction"};
constexpr Defect kSingular = {&MeshReport::num_singular_vertices,
                              "singular vertices"};

// A defect that is planted into a good mesh, and how often the report must show
// it.
struct Planted {
  const char* name;
  Defect defect;
  size_t expected;
  void (*plant)(TriangleMesh* mesh);
};

uint32_t AddVertex(TriangleMesh* mesh) {
  mesh->vertices.emplace_back(1, 2, 3);
  return static_cast<uint32_t>(mesh->vertices.size() - 1);
}

TEST(Topology, CatchesPlantedDefects) {
  const std::vector<Planted> all = {
      {"NotANumber", kNonFinite, 1,
       [](TriangleMesh* mesh) { mesh->vertices[3].y() = NAN; }},
      {"Infinite", kNonFinite, 1,
       [](TriangleMesh* mesh) { mesh->vertices[3].y() = -INFINITY; }},
      {"Unreferenced", kUnreferenced, 2,
       [](TriangleMesh* mesh) {
         AddVertex(mesh);
         AddVertex(mesh);
       }},
      {"IndexOutOfRange", kInvalid, 1,
       [](TriangleMesh* mesh) { mesh->facets[5][1] = 5 * 7; }},
      {"LargestIndex", kInvalid, 1,
       [](TriangleMesh* mesh) { mesh->facets[5][2] = UINT32_MAX; }},
      {"Degenerate", kDegenerate, 1,
       [](TriangleMesh* mesh) { mesh->facets[5][2] = mesh->facets[5][0]; }},
      {"DegenerateAdded", kDegenerate, 2,
       [](TriangleMesh* mesh) {
         mesh->facets.push_back({3, 4, 4});
         mesh->facets.push_back({3, 3, 3});
       }},
      {"Duplicate", kDuplicate, 1,
       [](TriangleMesh* mesh) {
         const auto [a, b, c] = mesh->facets[7];
         mesh->facets.push_back({b, c, a});
       }},
      {"ThirdFacetAtAnEdge", kNonManifold, 1,
       [](TriangleMesh* mesh) {
         const auto [a, b, c] = mesh->facets[7];
         mesh->facets.push_back({a, b, AddVertex(mesh)});
       }},
      {"Misoriented", kMisoriented, 3,
       [](TriangleMesh* mesh) {
         std::swap(mesh->facets[7][0], mesh->facets[7][1]);
       }},
      {"PinchedVertex", kSingular, 1,
       [](TriangleMesh* mesh) { MergeVertices(34, 16, mesh); }}};
  for (const Planted& planted : all) {
    SCOPED_TRACE(planted.name);
    TriangleMesh mesh = MakeTorus();
    ASSERT_TRUE(Analyze(mesh).IsManifold());
    planted.plant(&mesh);
    const MeshReport report = Analyze(mesh);
    EXPECT_EQ(report.*planted.defect.count, planted.expected);
    EXPECT_FALSE(report.IsManifold());
    EXPECT_TRUE(Has(report.Defects(), std::to_string(planted.expected) + " " +
                                          planted.defect.words));
    EXPECT_FALSE(HasManifoldLinks(mesh));
  }
}

// Facets of a vertex that share another vertex, again and again.
size_t CountFans(const TriangleMesh& mesh, uint32_t vertex) {
  std::vector<std::set<uint32_t>> fans;
  for (const Facet& facet : mesh.facets) {
    std::set<uint32_t> fan(facet.begin(), facet.end());
    if (fan.erase(vertex) == 0) {
      continue;
    }
    std::erase_if(fans, [&](const std::set<uint32_t>& other) {
      const bool touches = std::ranges::any_of(
          other, [&](uint32_t v) { return fan.contains(v); });
      if (touches) {
        fan.insert(other.begin(), other.end());
      }
      return touches;
    });
    fans.push_back(fan);
  }
  return fans.size();
}

// The counts of a mesh of few vertices and many facets, from the definitions.
MeshReport BruteForce(const TriangleMesh& mesh) {
  MeshReport report;
  std::map<std::set<uint32_t>, std::vector<bool>> edges;  // runs upwards
  std::map<std::set<uint32_t>, size_t> triples;
  for (const Facet& facet : mesh.facets) {
    ++triples[{facet.begin(), facet.end()}];
    for (int k = 0; k < 3; ++k) {
      const uint32_t u = facet[k];
      const uint32_t v = facet[(k + 1) % 3];
      edges[{u, v}].push_back(u < v);
    }
  }
  for (const auto& [triple, count] : triples) {
    report.num_duplicate_facets += count - 1;
  }
  report.num_edges = edges.size();
  std::set<uint32_t> singular;
  for (const auto& [edge, runs] : edges) {
    const auto up = std::ranges::count(runs, true);
    const auto down = std::ranges::count(runs, false);
    report.num_border_edges += runs.size() == 1;
    report.num_non_manifold_edges += runs.size() > 2;
    report.num_misoriented_edges += up > 1 || down > 1;
    if (runs.size() > 2) {
      singular.insert(edge.begin(), edge.end());
    }
  }
  for (uint32_t vertex = 0; vertex < mesh.vertices.size(); ++vertex) {
    const size_t num_fans = CountFans(mesh, vertex);
    report.num_unreferenced_vertices += num_fans == 0;
    if (num_fans > 1) {
      singular.insert(vertex);
    }
  }
  report.num_singular_vertices = singular.size();
  return report;
}

TEST(Topology, RandomSoups) {
  Random random(1);
  size_t num_manifold = 0;
  for (int trial = 0; trial < 5000; ++trial) {
    const uint32_t num_vertices = 4 + random.Below(8);
    TriangleMesh mesh =
        RandomSoup(num_vertices, 1 + random.Below(2 * num_vertices),
                   /*allow_duplicates=*/true, &random);
    if (random.Chance(0.5)) {
      DropUnusedVertices(&mesh);
    }
    const MeshReport expected = BruteForce(mesh);
    const MeshReport report = Analyze(mesh);
    ASSERT_EQ(report.num_edges, expected.num_edges);
    ASSERT_EQ(report.num_border_edges, expected.num_border_edges);
    ASSERT_EQ(report.Defects(), expected.Defects());
    ASSERT_EQ(report.IsManifold(), HasManifoldLinks(mesh)) << report.Defects();
    num_manifold += report.IsManifold();
  }
  EXPECT_GT(num_manifold, 20u);  // or nothing would have been compared
}

}  // namespace colmap_ext::topology_test
