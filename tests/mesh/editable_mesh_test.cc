#include "mesh/editable_mesh.h"

#include <vector>

#include <gtest/gtest.h>

#include "tests/mesh/manifold_links.h"
#include "tests/mesh/shapes.h"

namespace colmap_ext {
namespace editable_mesh_test {

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
      const uint32_t half =
          random.Below(static_cast<uint32_t>(edit.NumHalfEdges()));
      if (edit.IsRemovedFacet(half / 3)) {
        continue;
      }
      const uint32_t operation = random.Below(3);
      if (operation == 0) {
        const uint32_t middle = edit.Split(half);
        EXPECT_EQ(edit.To(half), middle);
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

}  // namespace editable_mesh_test
}  // namespace colmap_ext
