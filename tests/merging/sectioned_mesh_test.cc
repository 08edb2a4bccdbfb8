#include "merging/sectioned_mesh.h"

#include <algorithm>
#include <limits>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "merging/sectioned_repair.h"
#include "merging/sectioned_topology.h"
#include "mesh/fan_split.h"
#include "mesh/half_edges.h"
#include "spatial/facet_tree.h"
#include "tests/mesh/known_meshes.h"
#include "tests/mesh/random_soup.h"
#include "tests/mesh/shapes.h"
#include "tests/tiles/memory_store.h"

namespace colmap_ext {
namespace {

// Numbers the vertices in the order of their use; others are dropped.
TriangleMesh ByUse(const TriangleMesh& mesh) {
  std::map<uint32_t, uint32_t> numbers;
  TriangleMesh result;
  for (Facet facet : mesh.facets) {
    for (uint32_t& vertex : facet) {
      const auto [found, is_new] =
          numbers.try_emplace(vertex, static_cast<uint32_t>(numbers.size()));
      if (is_new) {
        result.vertices.push_back(mesh.vertices[vertex]);
      }
      vertex = found->second;
    }
    result.facets.push_back(facet);
  }
  return result;
}

// Cuts a mesh into sections of facets, [sections + 1] begins.
SectionedMesh InSections(const TriangleMesh& mesh,
                         const std::vector<uint32_t>& begins) {
  std::vector<std::set<size_t>> users(mesh.vertices.size());
  for (size_t section = 0; section + 1 < begins.size(); ++section) {
    for (uint32_t i = begins[section]; i < begins[section + 1]; ++i) {
      for (const uint32_t vertex : mesh.facets[i]) {
        users[vertex].insert(section);
      }
    }
  }
  SectionedMesh sections(MakeMemoryStore);
  uint32_t num_vertices = 0;
  for (size_t section = 0; section + 1 < begins.size(); ++section) {
    const std::vector<Facet> facets(mesh.facets.begin() + begins[section],
                                    mesh.facets.begin() + begins[section + 1]);
    std::vector<Eigen::Vector3f> positions;
    std::vector<uint32_t> shared;
    std::vector<Eigen::AlignedBox3f> boxes;
    for (uint32_t vertex = 0; vertex < mesh.vertices.size(); ++vertex) {
      if (users[vertex].contains(section) && users[vertex].size() > 1) {
        shared.push_back(vertex);
      }
    }
    for (uint32_t i = begins[section]; i < begins[section + 1]; ++i) {
      boxes.push_back(BoxOf(mesh, i));
      for (const uint32_t vertex : mesh.facets[i]) {
        if (vertex == num_vertices) {
          positions.push_back(mesh.vertices[num_vertices++]);
        }
      }
    }
    sections.Add(positions, facets, shared, boxes);
  }
  sections.Finish();
  return sections;
}

std::vector<uint32_t> RandomBegins(size_t num_facets, size_t num_sections,
                                   Random* random) {
  std::vector<uint32_t> begins = {0, static_cast<uint32_t>(num_facets)};
  while (begins.size() <= num_sections) {
    begins.push_back(random->Below(static_cast<uint32_t>(num_facets) + 1));
  }
  std::ranges::sort(begins);
  return begins;
}

void ExpectSameReport(const MeshReport& a, const MeshReport& b) {
  EXPECT_EQ(a.num_vertices, b.num_vertices);
  EXPECT_EQ(a.num_facets, b.num_facets);
  EXPECT_EQ(a.num_edges, b.num_edges);
  EXPECT_EQ(a.num_border_edges, b.num_border_edges);
  EXPECT_EQ(a.euler, b.euler);
  EXPECT_EQ(a.Defects(), b.Defects());
  if (b.IsManifold()) {
    EXPECT_EQ(a.num_components, b.num_components);
    EXPECT_EQ(a.num_border_loops, b.num_border_loops);
    EXPECT_EQ(a.genus, b.genus);
  }
}

TEST(AnalyzeSections, IsAnalyzeOfAnySoup) {
  Random random(1);
  for (int trial = 0; trial < 2000; ++trial) {
    const uint32_t num_vertices = 4 + random.Below(12);
    TriangleMesh mesh = ByUse(RandomSoup(
        num_vertices, 1 + random.Below(3 * num_vertices), true, &random));
    if (mesh.facets.empty()) {
      continue;
    }
    if (random.Chance(0.1)) {
      mesh.vertices[0].x() = std::numeric_limits<float>::quiet_NaN();
    }
    if (random.Chance(0.2)) {
      Facet& facet = mesh.facets.back();
      facet[1] = facet[0];
    } else if (random.Chance(0.5)) {
      mesh = SplitFans(mesh, PairHalfEdges(mesh.facets)).mesh;
    }
    mesh = ByUse(mesh);
    const auto begins =
        RandomBegins(mesh.facets.size(), 1 + random.Below(5), &random);
    ExpectSameReport(AnalyzeSections(InSections(mesh, begins)), Analyze(mesh));
    ASSERT_FALSE(HasFailure()) << trial;
  }
}

TEST(AnalyzeSections, CountsHandlesAndLoopsAcrossSections) {
  Random random(2);
  for (const TriangleMesh& shape :
       {Union(MakeTorus(), MakeCube()), MakeAnnulus(), MakeDisc(),
        Union(MakeRoundTorus(0.1f), MakeBumpyCap(0.1f)), MakeMoebiusStrip()}) {
    TriangleMesh mesh = shape;
    for (int trial = 0; trial < 10; ++trial) {
      random.Shuffle(&mesh.facets);
      const TriangleMesh by_use = ByUse(mesh);
      ExpectSameReport(
          AnalyzeSections(InSections(
              by_use, RandomBegins(mesh.facets.size(), 1 + trial, &random))),
          Analyze(by_use));
    }
  }
}

TEST(AnalyzeSections, NoticesUnusedVertices) {
  const TriangleMesh mesh = MakeTetrahedron();
  SectionedMesh sections(MakeMemoryStore);
  std::vector<Eigen::Vector3f> positions = mesh.vertices;
  positions.emplace_back(9, 9, 9);
  sections.Add(positions, mesh.facets, {}, std::vector<Eigen::AlignedBox3f>(4));
  sections.Finish();
  EXPECT_EQ(AnalyzeSections(sections).num_unreferenced_vertices, 1u);
}

// Sheets that cross each other, and copies of vertices at one place.
TriangleMesh CrossingMesh(Random* random) {
  TriangleMesh mesh = MakeSheet(12, 12);
  for (Eigen::Vector3f& vertex : mesh.vertices) {
    vertex.z() = 0.3f * static_cast<float>(random->Unit());
  }
  TriangleMesh other = MakeSheet(12, 12);
  for (Eigen::Vector3f& vertex : other.vertices) {
    vertex.z() = 0.31f + 0.3f * static_cast<float>(random->Unit()) -
                 (random->Chance(0.05) ? 0.2f : 0.0f);
    vertex.x() += 0.3f;
  }
  mesh = Union(mesh, other);
  for (int i = 0; i < 4; ++i) {
    const auto a = random->Below(static_cast<uint32_t>(mesh.vertices.size()));
    const auto b = random->Below(static_cast<uint32_t>(mesh.vertices.size()));
    mesh.vertices[a] = mesh.vertices[b];
  }
  return mesh;
}

TEST(RepairSections, IsTheRepairOfTheWhole) {
  Random random(3);
  size_t num_removed = 0;
  size_t num_flips = 0;
  for (int trial = 0; trial < 30; ++trial) {
    TriangleMesh mesh = CrossingMesh(&random);
    if (random.Chance(0.5)) {
      random.Shuffle(&mesh.facets);
    }
    mesh = ByUse(mesh);
    SectionedMesh sections = InSections(
        mesh, RandomBegins(mesh.facets.size(), 1 + random.Below(6), &random));
    EXPECT_EQ(FindSelfIntersections(sections), FindSelfIntersections(mesh));
    const SelfIntersectionRepair repair = RepairSections(&sections);
    const SelfIntersectionRepair whole = RepairSelfIntersections(&mesh);
    EXPECT_EQ(repair.num_before, whole.num_before);
    EXPECT_EQ(repair.num_after, whole.num_after);
    EXPECT_EQ(repair.num_moved_vertices, whole.num_moved_vertices);
    EXPECT_EQ(repair.num_flipped_edges, whole.num_flipped_edges);
    EXPECT_EQ(repair.mean_motion, whole.mean_motion);
    EXPECT_EQ(sections.ReadPositions(0, sections.NumVertices()), mesh.vertices);
    EXPECT_EQ(sections.ReadFacets(0, sections.NumFacets()), mesh.facets);
    ASSERT_FALSE(HasFailure()) << trial;
    num_removed += whole.num_before - whole.num_after;
    num_flips += whole.num_flipped_edges;
  }
  EXPECT_GT(num_removed, 100u);
  EXPECT_GT(num_flips, 0u);
}

}  // namespace
}  // namespace colmap_ext
