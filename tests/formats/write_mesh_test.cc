#include "formats/write_mesh.h"

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <thread>
#include <vector>

#include "formats/atomic_file.h"
#include "formats/read_ply.h"
#include "tests/formats/test_files.h"

namespace colmap_ext::write_mesh_test {

namespace fs = std::filesystem;

struct WriteMeshTest : FolderTest {
  WriteMeshTest() : FolderTest("mesh.ply") {}

  TriangleMesh mesh_ = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                        {{0, 2, 1}, {0, 1, 3}}};
  VertexAttributes attributes_ = {
      {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}, {255, 0, 10}},
      {{0, 1, 3, 3, 4}, {2, 0, 5, 7}}};
};

TEST_F(WriteMeshTest, WritesWhatOtherToolsReadAndIsReadBackAsItWas) {
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
    EXPECT_EQ(read.mesh, mesh_);
  }
}

TEST_F(WriteMeshTest, LeavesTheOldMeshWhereItFails) {
  WriteFile(path_, "old mesh");
  std::filesystem::create_directory(VisibilityPath(path_));
  ExpectFileError("", [&] { WriteMesh(path_, mesh_, attributes_); });
  EXPECT_EQ(ReadFile(path_), "old mesh");
  EXPECT_EQ(List(folder_.Path()), "mesh.ply mesh.ply.vis");
}

struct WriteLabeledMeshTest : FolderTest {
  WriteLabeledMeshTest() : FolderTest("labels.ply") {}
  void SetUp() override { WriteLabeledMesh(path_, mesh_, labels_); }

  // A strip of three triangles; no facet has the last vertex.
  TriangleMesh mesh_ = {
      {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 2, 0}, {9, 9, 9}},
      {{0, 1, 2}, {2, 1, 3}, {2, 3, 4}}};
  MeshLabels labels_ = {
      {1, -1, -1}, {{1, 2, 3}, {4, 5, 6}, {4, 5, 6}}, {"a b", "c d"}};
};

TEST_F(WriteLabeledMeshTest, IsReadWithLabelsAndSplitsVerticesOnlyBetweenThem) {
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
  const ColoredMesh read = ReadColoredPlyMesh(path_);
  EXPECT_EQ(read.labels, labels_.labels);
  EXPECT_EQ(read.label_names, labels_.names);
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
  EXPECT_TRUE(Has(bytes, "comment label 1: c d\n"));
  EXPECT_TRUE(Has(bytes, "property int label\n"));
  EXPECT_EQ(bytes.size(), data + 7 * (3 * 4 + 3 + 4) + 3 * (1 + 3 * 4));
}

struct ReadVisibilityTest : FolderTest {
  ReadVisibilityTest() : FolderTest("fused.ply.vis") {}

  static std::string Bytes(uint64_t num_points,
                           const std::vector<uint32_t>& numbers) {
    std::string bytes;
    Append(num_points, &bytes);
    for (const uint32_t number : numbers) {
      Append(number, &bytes);
    }
    return bytes;
  }

  void ExpectRefused(const std::string& bytes, size_t num_points,
                     const std::string& message) {
    WriteFile(path_, bytes);
    ExpectFileError(message, [&] { ReadVisibility(path_, num_points); });
  }

  // Three points, seen by {5, 1}, {} and {7}.
  const std::string bytes_ = Bytes(3, {2, 5, 1, 0, 1, 7});
};

TEST_F(ReadVisibilityTest, ReadsRowsAsTheyAre) {
  WriteFile(path_, bytes_);
  EXPECT_EQ(ReadVisibility(path_, 3), Visibility({0, 2, 2, 3}, {5, 1, 7}));
  ExpectEveryTruncationRefused(path_, 0, [this] { ReadVisibility(path_, 3); });
  WriteFile(path_, Bytes(2, {0, 0}));
  EXPECT_EQ(ReadVisibility(path_, 2), Visibility({0, 0, 0}, {}));
}

TEST_F(ReadVisibilityTest, SaysWhatDoesNotFitAndWhatToDo) {
  for (const char* text : {"no such file", "stereo_fusion"}) {
    ExpectFileError(text, [&] { ReadVisibility(path_, 2); });
  }
  ExpectRefused(bytes_ + '\0', 3, "1 bytes more");
  ExpectRefused(bytes_, 2, "is about 3 points, but the cloud has 2");
  ExpectRefused(bytes_, 2, "stereo_fusion");
  ExpectRefused(Bytes(1, {0xffffffff, 0}), 1, "promises");
  ExpectRefused(Bytes(~uint64_t{0}, {}), SIZE_MAX, "no room");
}

constexpr uid_t kNobody = 65534;

using AtomicFileTest = FolderTest;

TEST_F(AtomicFileTest, AppearsWhenCommitted) {
  WriteFile(path_ / "b", "old");
  {
    AtomicFiles files;
    WriteText(path_ / "a", "new a", &files);
    WriteText(path_ / "b", "new b", &files);
    files.Sync();
    EXPECT_FALSE(fs::exists(path_ / "a"));
    EXPECT_EQ(ReadFile(path_ / "b"), "old");
    files.Commit();
  }
  EXPECT_EQ(List(path_), "a b");
  EXPECT_EQ(ReadFile(path_ / "a"), "new a");
  EXPECT_EQ(ReadFile(path_ / "b"), "new b");
}

TEST_F(AtomicFileTest, LeavesNothingBehindUncommitted) {
  WriteFile(path_ / "a", "old");
  {
    AtomicFile a(path_ / "a");
    const std::string text(3 << 20, 'x');
    a.Write(text.data(), text.size());
    EXPECT_NE(List(path_), "a");
  }
  EXPECT_EQ(List(path_), "a");
  EXPECT_EQ(ReadFile(path_ / "a"), "old");
}

TEST_F(AtomicFileTest, KeepsOldFilesTogetherWhenTheDiskIsFull) {
  WriteFile(path_ / "a", "old");
  EXPECT_TRUE(FailsOnAFullDisk(
      1 << 20, [this] { WriteText(path_ / "a", std::string(3 << 20, 'x')); }));
  EXPECT_EQ(ReadFile(path_ / "a"), "old");
  EXPECT_EQ(List(path_), "a");
  for (const size_t size : {20, 3 << 20}) {  // as it is written, and synced
    EXPECT_TRUE(FailsOnAFullDisk(10, [&] {
      AtomicFiles files;
      WriteText(path_ / "a", "new", &files);
      WriteText(path_ / "b", std::string(size, 'x'), &files);
      files.Commit();
    }));
    EXPECT_EQ(ReadFile(path_ / "a"), "old");
    EXPECT_EQ(List(path_), "a");
  }
}

TEST_F(AtomicFileTest, RefusesPlacesThatCanNotBeWritten) {
  WriteFile(path_ / "file", "");
  fs::create_directory(path_ / "folder");
  for (const fs::path& path :
       {path_ / "none" / "a", path_ / "file" / "a", path_ / "folder",
        fs::path("/proc/a"), path_ / std::string(300, 'a')}) {
    SCOPED_TRACE(path);
    ExpectFileError("cannot be written", [&] { AtomicFile file(path); });
  }
  EXPECT_THROW(ExpectWritable(path_ / "folder"), FileError);
  EXPECT_NO_THROW(ExpectWritable(path_ / "file"));
  EXPECT_EQ(List(path_), "file folder");
}

TEST_F(AtomicFileTest, RefusesFoldersWithoutPermission) {
  fs::permissions(path_, fs::perms::owner_read | fs::perms::owner_exec |
                             fs::perms::others_read | fs::perms::others_exec);
  const int status = RunInChild([&] {
    if (geteuid() == 0 && setuid(kNobody) != 0) {  // root may write everywhere
      _exit(1);
    }
    AtomicFile file(path_ / "a");
  });
  fs::permissions(path_, fs::perms::owner_all);
  EXPECT_EQ(WEXITSTATUS(status), 7);
}

TEST_F(AtomicFileTest, WritesThroughSymbolicLinks) {
  WriteFile(path_ / "there" / "file", "old");
  fs::create_symlink(path_ / "there" / "file", path_ / "link");
  WriteText(path_ / "link", "new");
  EXPECT_TRUE(fs::is_symlink(path_ / "link"));
  EXPECT_EQ(ReadFile(path_ / "there" / "file"), "new");
}

TEST_F(AtomicFileTest, LeavesNothingBehindWhenInterrupted) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const int status = RunInChild([&] {
      AtomicFile a(path_ / "a");
      AtomicFile b(path_ / "b");
      raise(signal);
    });
    EXPECT_TRUE(WIFSIGNALED(status));
    EXPECT_EQ(WTERMSIG(status), signal);
    EXPECT_EQ(List(path_), "");
  }
}

// Whole files, and no others. That the list of temporary files has no data race
// is seen by the thread sanitizer.
TEST_F(AtomicFileTest, SeveralThreadsMayMakeFiles) {
  std::vector<std::thread> threads;
  for (int thread = 0; thread < 4; ++thread) {
    threads.emplace_back([this, text = std::string(9, '0' + thread)] {
      for (int i = 0; i < 20; ++i) {
        const AtomicFile dropped(path_ / "a");
        WriteText(path_ / "b", text);
      }
    });
  }
  for (std::thread& thread : threads) {
    thread.join();
  }
  EXPECT_EQ(List(path_), "b");
  const std::string text = ReadFile(path_ / "b");
  EXPECT_EQ(text, std::string(9, text.front()));
}

}  // namespace colmap_ext::write_mesh_test
