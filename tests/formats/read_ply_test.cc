#include "formats/read_ply.h"

#include <algorithm>

#include "formats/write_mesh.h"
#include "tests/formats/test_files.h"

namespace colmap_ext::read_ply_test {

// Two points (1, 2, 3) and (-4, 5.5, 6e2) with normals and colours.
constexpr double kValues[2][9] = {{1, 2, 3, 0, 0, 1, 10, 20, 30},
                                  {-4, 5.5, 6e2, 0, 1, 0, 255, 0, 128}};
constexpr const char* kNames[9] = {"x",  "y",   "z",     "nx",  "ny",
                                   "nz", "red", "green", "blue"};

struct Variant {
  std::string format = "binary_little_endian";
  std::string float_type = "float";
  std::vector<int> properties = {0, 1, 2, 3, 4, 5, 6, 7, 8};  // in kNames
  std::string line_end = "\n";
};

template <typename T>
void AppendAs(const Variant& variant, double value, std::string* bytes) {
  std::string raw;
  Append(static_cast<T>(value), &raw);
  if (variant.format == "binary_big_endian") {
    std::ranges::reverse(raw);
  }
  *bytes += raw;
}

void AppendValue(const Variant& variant, int property, double value,
                 std::string* bytes) {
  if (variant.format == "ascii") {
    *bytes += std::to_string(value) + " ";
  } else if (property >= 6) {
    AppendAs<uint8_t>(variant, value, bytes);
  } else if (variant.float_type == "double") {
    AppendAs<double>(variant, value, bytes);
  } else {
    AppendAs<float>(variant, value, bytes);
  }
}

std::string MakePly(const Variant& variant) {
  const std::string& end = variant.line_end;
  std::string bytes = "ply" + end + "format " + variant.format + " 1.0" + end +
                      "comment of no use" + end + "element vertex 2" + end;
  for (const int i : variant.properties) {
    bytes += "property " + (i < 6 ? variant.float_type : "uchar") + " " +
             kNames[i] + end;
  }
  bytes += "end_header" + end;
  for (const auto& values : kValues) {
    for (const int i : variant.properties) {
      AppendValue(variant, i, values[i], &bytes);
    }
    bytes += variant.format == "ascii" ? end : "";
  }
  return bytes;
}

// Three coordinates of that many vertices.
std::string AsciiHeader(int num_vertices) {
  return "ply\nformat ascii 1.0\nelement vertex " +
         std::to_string(num_vertices) +
         "\nproperty float x\nproperty float y\nproperty float z\n";
}

// \tparam kRead  reads a file
template <auto kRead>
struct ReadPlyTest : FolderTest {
  ReadPlyTest() : FolderTest("mesh.ply") {}

  auto Read(const std::string& bytes) {
    WriteFile(path_, bytes);
    return kRead(path_);
  }

  void ExpectRefused(const std::string& bytes, const std::string& message) {
    ExpectFileError(message, [&] { Read(bytes); });
  }
};

using ReadPlyCloudTest = ReadPlyTest<&ReadPlyCloud>;

void ExpectTheTwoPoints(const PlyCloud& cloud) {
  ASSERT_EQ(cloud.positions.size(), 2);
  EXPECT_EQ(cloud.positions[0], Eigen::Vector3f(1, 2, 3));
  EXPECT_EQ(cloud.positions[1], Eigen::Vector3f(-4, 5.5, 6e2));
  if (!cloud.colors.empty()) {
    EXPECT_EQ(cloud.colors[0], (Color{10, 20, 30}));
    EXPECT_EQ(cloud.colors[1], (Color{255, 0, 128}));
  }
  if (!cloud.normals.empty()) {
    EXPECT_EQ(cloud.normals[0], Eigen::Vector3f(0, 0, 1));
    EXPECT_EQ(cloud.normals[1], Eigen::Vector3f(0, 1, 0));
  }
}

TEST_F(ReadPlyCloudTest, ReadsEveryFormatTypeAndOrder) {
  const std::vector<std::vector<int>> orders = {{0, 1, 2, 3, 4, 5, 6, 7, 8},
                                                {8, 7, 6, 5, 4, 3, 2, 1, 0},
                                                {6, 7, 8, 0, 1, 2},
                                                {2, 0, 1}};
  for (const char* format :
       {"ascii", "binary_little_endian", "binary_big_endian"}) {
    for (const char* type : {"float", "float32", "double"}) {
      for (const std::vector<int>& order : orders) {
        for (const char* line_end : {"\n", "\r\n"}) {
          SCOPED_TRACE(std::string(format) + " " + type);
          const PlyCloud cloud = Read(MakePly({format, type, order, line_end}));
          ExpectTheTwoPoints(cloud);
          EXPECT_EQ(cloud.colors.size(), order.size() >= 6 ? 2 : 0);
          EXPECT_EQ(cloud.normals.size(), order.size() == 9 ? 2 : 0);
        }
      }
    }
  }
}

TEST_F(ReadPlyCloudTest, SkipsListsOtherPropertiesAndElements) {
  const PlyCloud cloud = Read(
      "ply\nformat ascii 1.0\n"
      "element camera 2\nproperty list uchar float params\nproperty int id\n"
      "element vertex 2\nproperty float x\nproperty list int short tags\n"
      "property float y\nproperty double quality\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_index\nend_header\n"
      "2 0.5 0.5 1\n0 7\n"
      "1 3 7 8 9 2 0.1 3\n-4 0 5.5 +0.2 6e2\n3 0 1 0\n");
  ExpectTheTwoPoints(cloud);
}

TEST_F(ReadPlyCloudTest, KeepsNotFinitePointsForTheCallerToDrop) {
  const PlyCloud cloud =
      Read(AsciiHeader(2) + "end_header\nnan inf -inf\n1e300 1 1");
  EXPECT_FALSE(cloud.positions[0].allFinite());
  EXPECT_FALSE(cloud.positions[1].allFinite());
}

TEST_F(ReadPlyCloudTest, CutsColorsOffToBytesAndIgnoresOtherTypes) {
  const PlyCloud cloud =
      Read(AsciiHeader(2) +
           "property uchar red\nproperty uchar green\nproperty uchar blue\n"
           "end_header\n"
           "1 2 3 nan -1 1e300\n1 2 3 254.9 inf -inf\n");
  ASSERT_EQ(cloud.colors.size(), 2);
  EXPECT_EQ(cloud.colors[0], (Color{0, 0, 255}));
  EXPECT_EQ(cloud.colors[1], (Color{254, 255, 0}));
  EXPECT_TRUE(Read(AsciiHeader(1) +
                   "property float red\nproperty float green\n"
                   "property float blue\nend_header\n1 2 3 0.5 0.5 0.5\n")
                  .colors.empty());
}

TEST_F(ReadPlyCloudTest, RefusesEveryTruncation) {
  for (const char* format : {"binary_little_endian", "binary_big_endian"}) {
    WriteFile(path_, MakePly({.format = format}));
    ExpectEveryTruncationRefused(path_, 0, [this] { ReadPlyCloud(path_); });
  }
  // Of "128.000000 \n" any digit may be the last.
  WriteFile(path_, MakePly({.format = "ascii"}));
  ExpectEveryTruncationRefused(path_, 12, [this] { ReadPlyCloud(path_); });
}

TEST_F(ReadPlyCloudTest, RefusesCountsLargerThanTheFile) {
  for (const char* format : {"ascii", "binary_little_endian"}) {
    for (const char* count : {"4000000000", "18446744073709551615"}) {
      std::string bytes = MakePly({.format = format});
      bytes.replace(bytes.find("vertex 2"), 8, std::string("vertex ") + count);
      ExpectRefused(bytes, "room for");
    }
  }
  std::string list =
      "ply\nformat binary_little_endian 1.0\nelement vertex 1\n"
      "property list uint double tags\nproperty float x\nproperty float y\n"
      "property float z\nend_header\n";
  Append(uint32_t{4000000000}, &list);
  list.append(100, '\0');
  ExpectRefused(list, "impossible length");
}

TEST_F(ReadPlyCloudTest, RefusesWhatIsNoPointCloud) {
  const std::string ascii = "ply\nformat ascii 1.0\n";
  for (const std::string& bytes :
       {std::string(), std::string("\n"), std::string("obj\n"),
        std::string("ply\nend_header\n"),
        std::string("ply\nformat ebcdic 1.0\n"),
        ascii + "property float x\nend_header\n", ascii + "end_header\n",
        ascii + "element vertex -1\nend_header\n",
        ascii + "element vertex 1\nproperty half x\n",
        ascii + "element vertex 1\nproperty list float int x\n",
        ascii + "element vertex 1\nproperty float x\nend_header\n1\n",
        AsciiHeader(1) + "end_header\n1 2 three\n"}) {
    SCOPED_TRACE(bytes);
    ExpectRefused(bytes, "mesh.ply: ");
  }
  ExpectFileError("", [&] { ReadPlyCloud(folder_.Path()); });
  ExpectFileError("", [&] { ReadPlyCloud(folder_.Path() / "no.ply"); });
}

constexpr const char* kVertices = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n";
constexpr const char* kFaces =
    "element face 2\nproperty list uchar int vertex_indices\nend_header\n";

struct ReadPlyMeshTest : ReadPlyTest<&ReadPlyMesh> {
  const TriangleMesh mesh_ = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                              {{0, 2, 1}, {0, 1, 3}}};
};

TEST_F(ReadPlyMeshTest, ReadsWhatIsWritten) {
  for (const std::vector<Color>& colors :
       {std::vector<Color>{}, std::vector<Color>(4, {1, 2, 3})}) {
    WriteColoredMesh(path_, mesh_, colors);
    EXPECT_EQ(List(folder_.Path()), "mesh.ply");
    EXPECT_EQ(ReadPlyMesh(path_), mesh_);
    EXPECT_EQ(ReadColoredPlyMesh(path_).colors, colors);
  }
  ExpectEveryTruncationRefused(path_, 0, [this] { ReadPlyMesh(path_); });
}

TEST_F(ReadPlyMeshTest, SkipsOtherPropertiesAndElements) {
  const TriangleMesh mesh =
      Read(AsciiHeader(4) +
           std::string("property list uchar int tags\nelement camera 1\n"
                       "property float f\nelement face 2\nproperty int label\n"
                       "property list uchar double vertex_index\n"
                       "property list uchar float texcoord\nend_header\n"
                       "0 0 0 0\n1 0 0 1 7\n0 1 0 2 7 8\n0 0 1 0\n0.5\n"
                       "9 3 0 2 1 2 0.5 0.5\n9 3 0 1 3 0\n"));
  EXPECT_EQ(mesh, mesh_);
}

TEST_F(ReadPlyMeshTest, ClampsConfidencesAndReadsPointsAsAMeshWithoutFacets) {
  const auto confidences = [this](const std::string& type) {
    Read(AsciiHeader(4) + ("property " + type + " confidence\n") + kFaces +
         "0 0 0 0.5\n1 0 0 -1\n0 1 0 nan\n0 0 1 7\n3 0 2 1\n3 0 1 3\n");
    return ReadColoredPlyMesh(path_).confidences;
  };
  EXPECT_EQ(confidences("double"), (std::vector<float>{0.5f, 0, 0, 1}));
  EXPECT_EQ(confidences("float"), (std::vector<float>{0.5f, 0, 0, 1}));
  const TriangleMesh mesh =
      Read(AsciiHeader(4) + std::string("end_header\n") + kVertices);
  EXPECT_EQ(mesh.vertices.size(), 4);
  EXPECT_TRUE(mesh.facets.empty());
}

TEST_F(ReadPlyMeshTest, RefusesWhatIsNoTriangleMesh) {
  const std::string begin = AsciiHeader(4) + std::string(kFaces) + kVertices;
  EXPECT_EQ(Read(begin + "3 0 2 1\n3 0 1 3\n").facets, mesh_.facets);
  ExpectRefused(begin + "3 0 2 1\n4 0 1 2 3\n",
                "face 1 has 4 corners, but only triangles");
  ExpectRefused(begin + "3 0 2 1\n2 0 1\n", "face 1 has 2 corners");
  ExpectRefused(begin + "3 0 2 1\n3 0 1 4\n", "face 1 has vertex 4");
  ExpectRefused(begin + "3 0 2 1\n3 0 1 -1\n", "no vertex's index");
  ExpectRefused(begin + "3 0 2 1\n3 0 1 1.5\n", "no vertex's index");
  ExpectRefused(begin + "3 0 2 1\n3 0 1 nan\n", "no vertex's index");
  ExpectRefused(begin + "3 0 2 1\n", "truncated");
  ExpectRefused(AsciiHeader(4) +
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

}  // namespace colmap_ext::read_ply_test
