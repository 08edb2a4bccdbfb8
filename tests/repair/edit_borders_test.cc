#include "repair/edit_borders.h"

#include <stdexcept>

#include <gtest/gtest.h>

#include "mesh/topology.h"
#include "tests/mesh/shapes.h"

namespace colmap_ext {
namespace edit_borders_test {

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

  Edited Edit(double trim, int close_holes) {
    Edited edited{{mesh_, attributes_}, {}, {}};
    edited.from =
        EditBorders({trim, close_holes}, confidences_, &edited, &edited.report);
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
  EXPECT_EQ(edited.report.trim.num_regions, 1);
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

}  // namespace edit_borders_test
}  // namespace colmap_ext
