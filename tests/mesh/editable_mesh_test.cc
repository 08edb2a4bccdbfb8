#include "mesh/editable_mesh.h"

#include <algorithm>
#include <map>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "mesh/adjacency.h"
#include "tests/mesh/known_meshes.h"
#include "tests/mesh/manifold_links.h"
#include "tests/threads.h"

namespace colmap_ext::editable_mesh_test {

std::vector<TriangleMesh> ManifoldMeshes() {
  Random random(1);
  std::vector<TriangleMesh> meshes = {
      MakeTetrahedron(),    MakeCube(),         MakeTorus(),
      MakeDisc(),           MakeAnnulus(),      MakeSheet(1, 1),
      MakeSheet(1, 5),      MakeBumpyCap(0.3F), MakeSheet(3, 3, true),
      MakeRoundTorus(0.25F)};
  for (int i = 0; i < 5; ++i) {
    meshes.push_back(MakeRandomManifold(&random));
  }
  return meshes;
}

TriangleMesh Result(const EditableMesh& edit) {
  MeshPart compact = edit.Compact();
  EXPECT_EQ(compact.mesh.vertices.size(), compact.vertices.size());
  EXPECT_EQ(compact.mesh.facets.size(), compact.facets.size());
  return std::move(compact.mesh);
}

// That partners, rings and borders agree with the facets.
void ExpectConsistent(const EditableMesh& edit) {
  size_t num_corners = 0;
  for (uint32_t vertex = 0; vertex < edit.NumVertices(); ++vertex) {
    if (edit.IsRemovedVertex(vertex)) {
      continue;
    }
    edit.ForEachOutgoing(vertex, [&](uint32_t half) {
      EXPECT_EQ(edit.From(half), vertex);
      EXPECT_FALSE(edit.IsRemovedFacet(half / 3));
      ++num_corners;
    });
  }
  size_t num_facets = 0;
  for (uint32_t half = 0; half < edit.NumHalfEdges(); ++half) {
    if (edit.IsRemovedFacet(half / 3)) {
      continue;
    }
    num_facets += half % 3 == 0 ? 1 : 0;
    const uint32_t partner = edit.Partner(half);
    if (partner != kNone) {
      EXPECT_EQ(edit.Partner(partner), half);
      EXPECT_EQ(edit.From(partner), edit.To(half));
      EXPECT_EQ(edit.To(partner), edit.From(half));
    } else {
      EXPECT_TRUE(edit.IsBorderVertex(edit.From(half)));
      EXPECT_TRUE(edit.IsBorderVertex(edit.To(half)));
    }
  }
  EXPECT_EQ(num_corners, 3 * num_facets);
}

TEST(EditableMesh, KeepsWhatIsNotEdited) {
  for (const TriangleMesh& mesh : ManifoldMeshes()) {
    const EditableMesh edit(mesh);
    ExpectConsistent(edit);
    EXPECT_EQ(Result(edit), mesh);
  }
}

// Any operations, where they are allowed, keep the topology.
TEST(EditableMesh, StaysManifoldUnderRandomOperations) {
  Random random(2);
  for (const TriangleMesh& mesh : ManifoldMeshes()) {
    EditableMesh edit(mesh);
    size_t num_collapses = 0;
    size_t num_flips = 0;
    for (int i = 0; i < 300; ++i) {
      const uint32_t half = random.Below(edit.NumHalfEdges());
      if (edit.IsRemovedFacet(half / 3)) {
        continue;
      }
      const uint32_t operation = random.Below(3);
      if (operation == 0) {
        EXPECT_EQ(edit.To(half), edit.Split(half));
      } else if (operation == 1 && edit.CanFlip(half)) {
        const uint32_t from = edit.From(half);
        const uint32_t apex = edit.Apex(edit.Partner(half));
        edit.Flip(half);
        EXPECT_EQ(edit.From(half), from);
        EXPECT_EQ(edit.To(half), apex);
        ++num_flips;
      } else if (operation == 2 && edit.CanCollapse(half)) {
        const uint32_t from = edit.From(half);
        edit.Collapse(half);
        EXPECT_TRUE(edit.IsRemovedVertex(from));
        ++num_collapses;
      }
      if (i % 50 == 0) {
        ExpectConsistent(edit);
      }
    }
    EXPECT_GT(num_flips, 0U);
    EXPECT_GT(num_collapses, 0U);
    ExpectConsistent(edit);
    ExpectSameTopology(mesh, Result(edit));
  }
}

// A collapse is allowed exactly where it leaves a manifold mesh of the same
// topology.
TEST(EditableMesh, LinkConditionIsThatOfTheResult) {
  for (const TriangleMesh& mesh :
       {MakeTetrahedron(), MakeCube(), MakeSheet(1, 3), MakeSheet(3, 3, true),
        MakeDisc(), MakeAnnulus()}) {
    EditableMesh edit(mesh);
    size_t num_allowed = 0;
    for (uint32_t half = 0; half < edit.NumHalfEdges(); ++half) {
      TriangleMesh merged = mesh;
      MergeVertices(edit.From(half), edit.To(half), &merged);
      std::erase_if(merged.facets, RepeatsVertex);
      DropUnusedVertices(&merged);
      const MeshReport before = Analyze(mesh);
      const MeshReport after = Analyze(merged);
      const bool is_same = after.IsManifold() &&
                           after.num_vertices + 1 == before.num_vertices &&
                           after.euler == before.euler &&
                           after.num_components == before.num_components &&
                           after.num_border_loops == before.num_border_loops;
      EXPECT_EQ(edit.CanCollapse(half), is_same);
      num_allowed += is_same ? 1 : 0;
    }
    EXPECT_EQ(num_allowed == 0,
              mesh.facets.size() == 4 && mesh.vertices.size() == 4);
  }
}

TEST(EditableMesh, FlippedTwiceIsTheSameSurface) {
  const TriangleMesh mesh = MakeDisc();
  EditableMesh edit(mesh);
  for (uint32_t half = 0; half < edit.NumHalfEdges(); ++half) {
    if (edit.CanFlip(half)) {
      const uint32_t apex = edit.Apex(half);
      const uint32_t from = edit.From(half);
      const uint32_t to = edit.To(half);
      edit.Flip(half);
      edit.Flip(NextHalfEdge(half));
      // The diagonal is back, between the same two facets.
      bool is_back = false;
      edit.ForEachOutgoing(from, [&](uint32_t outgoing) {
        is_back |= edit.To(outgoing) == to && edit.Apex(outgoing) == apex;
      });
      EXPECT_TRUE(is_back);
    }
  }
}

TEST(HalfEdges, RunAroundTheirFacet) {
  const std::vector<Facet> facets = {{4, 7, 9}, {7, 4, 2}};
  EXPECT_EQ(FromVertex(facets, 0), 4);
  EXPECT_EQ(ToVertex(facets, 0), 7);
  EXPECT_EQ(FromVertex(facets, 5), 2);
  EXPECT_EQ(ToVertex(facets, 5), 7);
  for (uint32_t half = 0; half < 6; ++half) {
    EXPECT_EQ(NextHalfEdge(half) / 3, half / 3);
    EXPECT_EQ(ToVertex(facets, half), FromVertex(facets, NextHalfEdge(half)));
  }
}

TEST(ForEachEdge, GathersTheHalfEdgesOfEachEdge) {
  Random random(1);
  for (const TriangleMesh& mesh :
       {TriangleMesh(), MakeTetrahedron(), MakeAnnulus(),
        RandomSoup(9, 40, true, &random)}) {
    const std::vector<Facet>& facets = mesh.facets;
    std::map<std::set<uint32_t>, std::vector<uint32_t>> expected;
    for (uint32_t half = 0; half < 3 * facets.size(); ++half) {
      expected[{FromVertex(facets, half), ToVertex(facets, half)}].push_back(
          half);
    }
    std::map<std::set<uint32_t>, std::vector<uint32_t>> edges;
    std::vector<std::set<uint32_t>> in_order;
    ForEachEdge(facets, [&](auto first, auto last) {
      std::vector<uint32_t> edge;
      for (auto it = first; it != last; ++it) {
        edge.push_back(it->second);
      }
      const std::set<uint32_t> vertices = {FromVertex(facets, edge[0]),
                                           ToVertex(facets, edge[0])};
      EXPECT_TRUE(edges.emplace(vertices, edge).second);
      in_order.push_back(vertices);
    });
    EXPECT_EQ(edges, expected);
    EXPECT_TRUE(std::ranges::is_sorted(in_order));
  }
}

TEST(PairHalfEdges, PairsWhatTwoFacetsRunInOppositeDirections) {
  Random random(1);
  size_t num_paired = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const TriangleMesh mesh = RandomSoup(8, 14, trial % 2 == 0, &random);
    const std::vector<uint32_t> partners = PairHalfEdges(mesh.facets);
    ASSERT_EQ(partners.size(), 3 * mesh.facets.size());
    for (uint32_t half = 0; half < partners.size(); ++half) {
      std::vector<uint32_t> others;  // of the undirected edge
      const uint32_t from = FromVertex(mesh.facets, half);
      const uint32_t to = ToVertex(mesh.facets, half);
      for (uint32_t other = 0; other < partners.size(); ++other) {
        const std::set<uint32_t> ends = {FromVertex(mesh.facets, other),
                                         ToVertex(mesh.facets, other)};
        if (other != half && ends == std::set<uint32_t>{from, to}) {
          others.push_back(other);
        }
      }
      const bool is_paired =
          others.size() == 1 && FromVertex(mesh.facets, others.front()) == to;
      ASSERT_EQ(partners[half], is_paired ? others.front() : kNone);
      num_paired += is_paired ? 1 : 0;
    }
  }
  EXPECT_GT(num_paired, 1000u);  // or it was not tested
}

// From the definitions.
void ExpectRings(const TriangleMesh& mesh) {
  const VertexRings rings = MakeVertexRings(mesh);
  const size_t num_vertices = mesh.vertices.size();
  ASSERT_EQ(rings.NumVertices(), num_vertices);
  ASSERT_EQ(rings.neighbors.offsets.size(), num_vertices + 1);
  ASSERT_EQ(rings.corners.offsets.size(), num_vertices + 1);
  // [V] how many facets the edge to each neighbour has.
  std::vector<std::map<uint32_t, int>> edges(num_vertices);
  std::vector<std::vector<uint32_t>> corners(num_vertices);
  for (uint32_t corner = 0; corner < 3 * mesh.facets.size(); ++corner) {
    const Facet& facet = mesh.facets[corner / 3];
    corners[facet[corner % 3]].push_back(corner);
    ++edges[facet[corner % 3]][facet[(corner + 1) % 3]];
    ++edges[facet[corner % 3]][facet[(corner + 2) % 3]];
  }
  for (size_t v = 0; v < num_vertices; ++v) {
    EXPECT_TRUE(std::ranges::equal(rings.corners[v], corners[v]));
    std::vector<uint32_t> expected;
    bool is_border = false;
    for (const auto& [neighbor, num_facets] : edges[v]) {
      expected.push_back(neighbor);
      is_border |= num_facets == 1;
    }
    EXPECT_TRUE(std::ranges::equal(rings.neighbors[v], expected));
    EXPECT_EQ(rings.is_border[v] != 0, is_border);
  }
}

TEST(VertexRings, OfRandomSoups) {
  Random random(1);
  for (int trial = 0; trial < 500; ++trial) {
    ExpectRings(RandomSoup(4 + random.Below(8), random.Below(20),
                           /*allow_duplicates=*/true, &random));
    ASSERT_FALSE(HasFailure());
  }
}

TEST(VertexRings, AreTheSameForAnyNumberOfThreads) {
  const TriangleMesh mesh = MakeBumpySphere(0.03f);
  ExpectSameForAnyThreads([&] { return MakeVertexRings(mesh); });
}

}  // namespace colmap_ext::editable_mesh_test
