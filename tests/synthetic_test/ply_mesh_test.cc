#include "tests/synthetic/ply_mesh.h"

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

namespace colmap_ext::synthetic {
namespace {

// A square in the plane z = 0.
PlyMesh Square() {
  PlyMesh ply;
  ply.mesh.vertices = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  ply.mesh.facets = {{0, 1, 2}, {0, 2, 3}};
  return ply;
}

class PlyMeshFile : public testing::Test {
 protected:
  ~PlyMeshFile() override { std::filesystem::remove(path_); }

  void Write(const std::string& text) {
    std::ofstream(path_, std::ios::binary) << text;
  }

  const std::string path_ =
      (std::filesystem::path(testing::TempDir()) /
       (std::string("ply_mesh_") +
        testing::UnitTest::GetInstance()->current_test_info()->name() + ".ply"))
          .string();
};

TEST_F(PlyMeshFile, IsReadAsWritten) {
  const TriangleMesh mesh = Square().mesh;
  WritePlyMesh(path_, mesh);
  const PlyMesh read = ReadPlyMesh(path_);
  EXPECT_EQ(read.mesh.vertices, mesh.vertices);
  EXPECT_EQ(read.mesh.facets, mesh.facets);
}

TEST_F(PlyMeshFile, TextWithColorsLabelsAndAQuadrilateral) {
  Write(
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty uchar red\n"
      "property uchar green\nproperty uchar blue\nproperty float x\n"
      "property float y\nproperty float z\nelement face 1\n"
      "property list uchar int vertex_indices\nproperty int label\n"
      "end_header\n1 2 3 0 0 0\n1 2 3 1 0 0\n1 2 3 1 1 0\n1 2 3 0 1 0\n"
      "4 0 1 2 3 7\n");
  const PlyMesh ply = ReadPlyMesh(path_);
  EXPECT_EQ(ply.colors[3], (Color{1, 2, 3}));
  EXPECT_EQ(ply.mesh.vertices[2], Eigen::Vector3f(1, 1, 0));
  ASSERT_EQ(ply.mesh.facets.size(), 2);
  EXPECT_EQ(ply.mesh.facets[1], (Facet{0, 2, 3}));
  EXPECT_EQ(ply.labels, (std::vector<int32_t>{7, 7}));
}

TEST_F(PlyMeshFile, LabelsOfVerticesAreThoseOfTheirFacets) {
  Write(
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\n"
      "property float y\nproperty float z\nproperty int label\n"
      "element face 1\nproperty list uchar int vertex_indices\n"
      "end_header\n0 0 0 7\n1 0 0 7\n1 1 0 7\n0 1 0 7\n4 0 1 2 3\n");
  EXPECT_EQ(ReadPlyMesh(path_).labels, (std::vector<int32_t>{7, 7}));
}

TEST_F(PlyMeshFile, RefusesWhatIsBroken) {
  EXPECT_THROW(ReadPlyMesh(path_), std::runtime_error);
  Write("hello");
  EXPECT_THROW(ReadPlyMesh(path_), std::runtime_error);
  WritePlyMesh(path_, Square().mesh);
  std::filesystem::resize_file(path_, std::filesystem::file_size(path_) - 1);
  EXPECT_THROW(ReadPlyMesh(path_), std::runtime_error);
  TriangleMesh mesh = Square().mesh;
  mesh.facets[0][0] = 4;
  WritePlyMesh(path_, mesh);
  EXPECT_THROW(ReadPlyMesh(path_), std::runtime_error);
}

}  // namespace
}  // namespace colmap_ext::synthetic
