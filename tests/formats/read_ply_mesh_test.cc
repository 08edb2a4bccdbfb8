#include "formats/read_ply.h"

#include <cstdint>

#include "formats/write_mesh.h"
#include "tests/formats/test_files.h"

namespace colmap_ext::read_ply_mesh_test {

constexpr const char* kHeader =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\n"
    "property float y\nproperty float z\n";
constexpr const char* kVertices = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n";
constexpr const char* kFaces =
    "element face 2\nproperty list uchar int vertex_indices\nend_header\n";

class ReadPlyMeshTest : public FolderTest {
 protected:
  ReadPlyMeshTest() : FolderTest("mesh.ply") {}

  TriangleMesh Read(const std::string& bytes) {
    WriteFile(path_, bytes);
    return ReadPlyMesh(path_);
  }

  void ExpectRefused(const std::string& bytes, const std::string& message) {
    ExpectFileError(message, [&] { Read(bytes); });
  }

  const TriangleMesh mesh_ = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                              {{0, 2, 1}, {0, 1, 3}}};
};

TEST_F(ReadPlyMeshTest, ReadsWhatIsWritten) {
  for (const std::vector<Color>& colors :
       {std::vector<Color>{}, std::vector<Color>(4, {1, 2, 3})}) {
    WriteColoredMesh(path_, mesh_, colors);
    EXPECT_EQ(List(folder_.Path()), "mesh.ply");
    const TriangleMesh mesh = ReadPlyMesh(path_);
    EXPECT_EQ(mesh.vertices, mesh_.vertices);
    EXPECT_EQ(mesh.facets, mesh_.facets);
    EXPECT_EQ(ReadColoredPlyMesh(path_).colors, colors);
  }
  ExpectEveryTruncationRefused(path_, 0, [this] { ReadPlyMesh(path_); });
}

TEST_F(ReadPlyMeshTest, SkipsOtherPropertiesAndElements) {
  const TriangleMesh mesh =
      Read(kHeader +
           std::string("property list uchar int tags\nelement camera 1\n"
                       "property float f\nelement face 2\nproperty int label\n"
                       "property list uchar double vertex_index\n"
                       "property list uchar float texcoord\nend_header\n"
                       "0 0 0 0\n1 0 0 1 7\n0 1 0 2 7 8\n0 0 1 0\n0.5\n"
                       "9 3 0 2 1 2 0.5 0.5\n9 3 0 1 3 0\n"));
  EXPECT_EQ(mesh.vertices, mesh_.vertices);
  EXPECT_EQ(mesh.facets, mesh_.facets);
}

TEST_F(ReadPlyMeshTest, ClampsConfidences) {
  const auto confidences = [this](const std::string& type) {
    Read(kHeader + ("property " + type + " confidence\n") + kFaces +
         "0 0 0 0.5\n1 0 0 -1\n0 1 0 nan\n0 0 1 7\n3 0 2 1\n3 0 1 3\n");
    return ReadColoredPlyMesh(path_).confidences;
  };
  EXPECT_EQ(confidences("double"), (std::vector<float>{0.5f, 0, 0, 1}));
  EXPECT_EQ(confidences("float"), (std::vector<float>{0.5f, 0, 0, 1}));
}

TEST_F(ReadPlyMeshTest, ReadsPointsAsAMeshWithoutFacets) {
  const TriangleMesh mesh =
      Read(kHeader + std::string("end_header\n") + kVertices);
  EXPECT_EQ(mesh.vertices.size(), 4);
  EXPECT_TRUE(mesh.facets.empty());
}

TEST_F(ReadPlyMeshTest, RefusesWhatIsNoTriangleMesh) {
  const std::string begin = kHeader + std::string(kFaces) + kVertices;
  EXPECT_EQ(Read(begin + "3 0 2 1\n3 0 1 3\n").facets, mesh_.facets);
  ExpectRefused(begin + "3 0 2 1\n4 0 1 2 3\n",
                "face 1 has 4 corners, but only triangles");
  ExpectRefused(begin + "3 0 2 1\n2 0 1\n", "face 1 has 2 corners");
  ExpectRefused(begin + "3 0 2 1\n3 0 1 4\n", "face 1 has vertex 4");
  ExpectRefused(begin + "3 0 2 1\n3 0 1 -1\n", "no vertex's index");
  ExpectRefused(begin + "3 0 2 1\n3 0 1 1.5\n", "no vertex's index");
  ExpectRefused(begin + "3 0 2 1\n3 0 1 nan\n", "no vertex's index");
  ExpectRefused(begin + "3 0 2 1\n", "truncated");
  ExpectRefused(kHeader +
                    std::string("element face 1\nproperty int a\n"
                                "end_header\n") +
                    kVertices + "1\n",
                "vertex_index");
  ExpectRefused("ply\nformat ascii 1.0\nend_header\n", "no vertices");
  ExpectRefused("hello\nworld\n", "not a PLY");
}

// The files are sparse: nothing lies on the disk behind the header.
TEST_F(ReadPlyMeshTest, RefusesMoreThanCanBeNumbered) {
  const auto make = [this](const std::string& elements, uint64_t num_bytes) {
    const std::string header =
        "ply\nformat binary_little_endian 1.0\n" + elements + "end_header\n";
    WriteFile(path_, header);
    std::filesystem::resize_file(path_, header.size() + num_bytes);
  };
  const std::string vertex =
      "property uchar x\nproperty uchar y\nproperty uchar z\n";
  const uint64_t num_vertices = uint64_t{1} << 32;
  make("element vertex 4294967296\n" + vertex, 3 * num_vertices);
  const std::string message =
      "has 4294967296 vertex elements, but at most 4294967295";
  ExpectFileError(message, [&] { ReadPlyMesh(path_); });
  ExpectFileError(message, [&] { ReadPlyCloud(path_); });
  const uint64_t num_facets = num_vertices / 3 + 1;
  make("element vertex 1\n" + vertex + "element face 1431655766\n" +
           "property list uchar uchar vertex_index\n",
       3 + num_facets);
  ExpectFileError("has 1431655766 face elements, but at most 1431655765",
                  [&] { ReadPlyMesh(path_); });
}

}  // namespace colmap_ext::read_ply_mesh_test
