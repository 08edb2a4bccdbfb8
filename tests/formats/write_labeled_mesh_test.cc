#include "formats/write_mesh.h"

#include "formats/read_ply_cloud.h"
#include "formats/read_ply_mesh.h"
#include "tests/formats/test_files.h"

namespace colmap_ext {
namespace write_labeled_mesh_test {

class WriteLabeledMeshTest : public testing::Test {
 protected:
  void SetUp() override { WriteLabeledMesh(path_, mesh_, labels_); }

  TemporaryFolder folder_;
  std::filesystem::path path_ = folder_.Path() / "labels.ply";
  // A strip of three triangles; no facet has the last vertex.
  TriangleMesh mesh_ = {
      {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 2, 0}, {9, 9, 9}},
      {{0, 1, 2}, {2, 1, 3}, {2, 3, 4}}};
  MeshLabels labels_ = {
      {1, -1, -1}, {{1, 2, 3}, {4, 5, 6}, {4, 5, 6}}, {"a b", "c d"}};
};

TEST_F(WriteLabeledMeshTest, KeepsTheFacetsAndTheirColors) {
  const TriangleMesh mesh = ReadPlyMesh(path_);
  const PlyCloud vertices = ReadPlyCloud(path_);
  ASSERT_EQ(mesh.facets.size(), mesh_.facets.size());
  for (size_t i = 0; i < mesh.facets.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      EXPECT_EQ(mesh.vertices[mesh.facets[i][k]],
                mesh_.vertices[mesh_.facets[i][k]]);
      EXPECT_EQ(vertices.colors[mesh.facets[i][k]], labels_.colors[i]);
    }
  }
}

TEST_F(WriteLabeledMeshTest, IsReadWithLabelsAndTheirNames) {
  const ColoredMesh read = ReadColoredPlyMesh(path_);
  EXPECT_EQ(read.labels, labels_.labels);
  EXPECT_EQ(read.label_names, labels_.names);
}

TEST_F(WriteLabeledMeshTest, SplitsVerticesOnlyBetweenLabels) {
  const TriangleMesh mesh = ReadPlyMesh(path_);
  EXPECT_EQ(mesh.vertices.size(), 3 + 4);
  EXPECT_EQ(mesh.facets[1][2], mesh.facets[2][1]);
  EXPECT_NE(mesh.facets[0][1], mesh.facets[1][1]);
}

// COLMAP 4's reader of meshes reads a face's list, and takes what follows for
// the next face.
TEST_F(WriteLabeledMeshTest, HasNothingButAListInAFace) {
  const std::string bytes = ReadFile(path_);
  const std::string end =
      "element face 3\nproperty list uchar int vertex_index\nend_header\n";
  const size_t data = bytes.find(end) + end.size();
  ASSERT_NE(bytes.find(end), std::string::npos);
  EXPECT_NE(bytes.find("comment label 1: c d\n"), std::string::npos);
  EXPECT_NE(bytes.find("property int label\n"), std::string::npos);
  EXPECT_EQ(bytes.size(), data + 7 * (3 * 4 + 3 + 4) + 3 * (1 + 3 * 4));
}

}  // namespace write_labeled_mesh_test
}  // namespace colmap_ext
