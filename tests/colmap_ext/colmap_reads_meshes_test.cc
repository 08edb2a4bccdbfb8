// COLMAP 4's own reader of meshes, which its window, mesh_texturer and
// mesh_simplifier use, reads what we write.

#if COLMAP_EXT_COLMAP_VERSION >= 40000

#include <colmap/util/ply.h>

#include "formats/write_mesh.h"
#include "tests/formats/test_files.h"

namespace colmap_ext::colmap_reads_meshes_test {

struct ColmapReadsMeshesTest : testing::Test {
  colmap::PlyMesh Read() const {
    return colmap::ReadPlyMesh(path_.string()).mesh;
  }

  TemporaryFolder folder_;
  std::filesystem::path path_ = folder_.Path() / "mesh.ply";
  TriangleMesh mesh_ = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0.5}},
                        {{0, 1, 2}, {2, 1, 3}}};
};

TEST_F(ColmapReadsMeshesTest, WithColorsAndConfidences) {
  WriteMesh(path_, mesh_,
            {{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}, {255, 0, 10}},
             {{0, 1, 1, 1, 1}, {0}},
             {0, 0.5, 1, 1}});
  const colmap::PlyMesh read = Read();
  ASSERT_EQ(read.vertices.size(), 4);
  ASSERT_EQ(read.faces.size(), 2);
  EXPECT_EQ(read.vertices[3].z, 0.5F);
  EXPECT_EQ(read.faces[1].vertex_idx1, 2);
  EXPECT_EQ(read.faces[1].vertex_idx3, 3);
}

TEST_F(ColmapReadsMeshesTest, WithLabels) {
  WriteLabeledMesh(path_, mesh_, {{0, 1}, {{1, 2, 3}, {4, 5, 6}}, {"a", "b"}});
  const colmap::PlyMesh read = Read();
  EXPECT_EQ(read.vertices.size(), 6);
  ASSERT_EQ(read.faces.size(), 2);
  EXPECT_EQ(read.vertices[read.faces[1].vertex_idx3].z, 0.5F);
}

}  // namespace colmap_ext::colmap_reads_meshes_test

#endif
