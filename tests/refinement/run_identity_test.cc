#include "colmap_ext/refinement/run_identity.h"

#include "colmap_ext/refinement/file_fingerprint.h"
#include "tests/formats/test_files.h"
#include "tests/workspace/netpbm_decoder.h"
#include "tests/workspace/sphere_workspace.h"

namespace colmap_ext {
namespace run_identity_test {

namespace fs = std::filesystem;

class RunIdentityTest : public testing::Test {
 protected:
  RunIdentityTest() {
    sphere_.Write(path_);
    WriteFile(path_ / "mesh.ply",
              "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
              "property float y\nproperty float z\nelement face 1\n"
              "property list uchar int vertex_index\nend_header\n"
              "1 0 0\n0 1 0\n0 0 1\n3 0 1 2\n");
  }

  RunIdentity Identify() const {
    RefinerOptions options = options_;
    options.workspace_path = path_.string();
    options.input_path = (path_ / "mesh.ply").string();
    options.output_path = (path_ / "refined.ply").string();
    options.Finish();
    const RefinementPaths paths = FindRefinementPaths(options);
    return IdentifyRun(
        options, paths,
        ReadRefinementInput(options, paths, NetpbmDecoder(), {}));
  }

  // The name of the only pair that is not what it was; "" for none, "several".
  std::string Changed() const {
    const RunIdentity now = Identify();
    std::string changed;
    EXPECT_EQ(now.size(), before_.size());
    for (size_t i = 0; i < now.size(); ++i) {
      EXPECT_EQ(now[i].first, before_[i].first);
      if (now[i].second != before_[i].second) {
        changed = changed.empty() ? now[i].first : "several";
      }
    }
    return changed;
  }

  void ChangeByte(const std::string& name, size_t position) const {
    std::string bytes = ReadFile(path_ / name);
    bytes[position] = static_cast<char>(bytes[position] ^ 1);
    WriteFile(path_ / name, bytes);
  }

  TemporaryFolder folder_;
  fs::path path_ = folder_.Path();
  SphereWorkspace sphere_;
  RefinerOptions options_;
  RunIdentity before_;
};

TEST_F(RunIdentityTest, TellsWhichFileWasChanged) {
  const std::string picture = "images/" + sphere_.images[2].view.name;
  for (const auto& [name, position] :
       {std::pair<std::string, size_t>("sparse/cameras.bin", 32),
        std::pair<std::string, size_t>("sparse/images.bin", 44),
        std::pair<std::string, size_t>("sparse/points3D.bin", 16),
        std::pair<std::string, size_t>("fused.ply", 300),
        std::pair<std::string, size_t>(picture, 100)}) {
    before_ = Identify();
    EXPECT_EQ(Changed(), "");
    ChangeByte(name, position);
    EXPECT_EQ(Changed(), name);
  }
}

TEST_F(RunIdentityTest, TellsTheOptionThatWasChanged) {
  before_ = Identify();
  options_.refinement.smoothness_weight = 0.1 + 0.2;
  EXPECT_EQ(Changed(), "smoothness_weight");
  options_.refinement.smoothness_weight = 1;
  options_.num_threads = 1;
  options_.max_memory_gb = 1;
  EXPECT_EQ(Changed(), "") << "these do not change the result";
}

TEST(FingerprintTest, TellsFilesApart) {
  const TemporaryFolder folder;
  const fs::path path = folder.Path() / "file";
  EXPECT_EQ(Fingerprint(path), "none");
  WriteFile(path, "");
  EXPECT_EQ(Fingerprint(path), "0 bytes, hash cbf29ce484222325");
  WriteFile(path, "a");  // of the authors' test suite
  EXPECT_EQ(Fingerprint(path), "1 bytes, hash af63dc4c8601ec8c");
  EXPECT_EQ(Fingerprints({path, folder.Path() / "none"}),
            (std::vector<std::string>{Fingerprint(path), "none"}));
}

}  // namespace run_identity_test
}  // namespace colmap_ext
