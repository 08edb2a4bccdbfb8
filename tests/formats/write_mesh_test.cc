#include "formats/write_mesh.h"

#include <cstring>

#include "formats/read_ply.h"
#include "tests/formats/test_files.h"

namespace colmap_ext::write_mesh_test {

class WriteMeshTest : public FolderTest {
 protected:
  WriteMeshTest() : FolderTest("mesh.ply") {}

  TriangleMesh mesh_ = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                        {{0, 2, 1}, {0, 1, 3}}};
  VertexAttributes attributes_ = {
      {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}, {255, 0, 10}},
      {{0, 1, 3, 3, 4}, {2, 0, 5, 7}}};
};

TEST_F(WriteMeshTest, WritesWhatOtherToolsRead) {
  WriteMesh(path_, mesh_, attributes_);
  const std::string bytes = ReadFile(path_);
  const std::string header =
      "ply\nformat binary_little_endian 1.0\nelement vertex 4\n"
      "property float x\nproperty float y\nproperty float z\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\n"
      "element face 2\nproperty list uchar int vertex_index\nend_header\n";
  EXPECT_EQ(bytes.substr(0, header.size()), header);
  ASSERT_EQ(bytes.size(), header.size() + 4 * 15 + 2 * 13);
  std::string faces;
  for (const Facet& facet : mesh_.facets) {
    Append(uint8_t{3}, &faces);
    Append(facet, &faces);
  }
  EXPECT_EQ(bytes.substr(header.size() + 4 * 15), faces);
}

TEST_F(WriteMeshTest, IsReadBackAsItWas) {
  WriteMesh(path_, mesh_, attributes_);
  const PlyCloud cloud = ReadPlyCloud(path_);
  EXPECT_EQ(cloud.positions, mesh_.vertices);
  EXPECT_EQ(cloud.colors, attributes_.colors);
  EXPECT_EQ(ReadVisibility(VisibilityPath(path_), 4), attributes_.views);
  EXPECT_EQ(List(folder_.Path()), "mesh.ply mesh.ply.vis");
}

TEST_F(WriteMeshTest, LeavesOutColorsAndConfidencesThatAreNotThere) {
  const VertexAttributes all = {
      attributes_.colors, attributes_.views, {0, 0.25f, 1, 0.1f}};
  for (const int given : {0, 1, 2, 3}) {
    attributes_ = all;
    if ((given & 1) == 0) {
      attributes_.colors.clear();
    }
    if ((given & 2) == 0) {
      attributes_.confidences.clear();
    }
    WriteMesh(path_, mesh_, attributes_);
    const ColoredMesh read = ReadColoredPlyMesh(path_);
    EXPECT_EQ(read.confidences, attributes_.confidences);
    EXPECT_EQ(read.colors, attributes_.colors);
    EXPECT_EQ(read.mesh.vertices, mesh_.vertices);
    EXPECT_EQ(read.mesh.facets, mesh_.facets);
  }
}

TEST_F(WriteMeshTest, LeavesTheOldMeshWhereItFails) {
  WriteFile(path_, "old mesh");
  std::filesystem::create_directory(VisibilityPath(path_));
  ExpectFileError("", [&] { WriteMesh(path_, mesh_, attributes_); });
  EXPECT_EQ(ReadFile(path_), "old mesh");
  EXPECT_EQ(List(folder_.Path()), "mesh.ply mesh.ply.vis");
}

class WriteLabeledMeshTest : public FolderTest {
 protected:
  WriteLabeledMeshTest() : FolderTest("labels.ply") {}
  void SetUp() override { WriteLabeledMesh(path_, mesh_, labels_); }

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

}  // namespace colmap_ext::write_mesh_test
