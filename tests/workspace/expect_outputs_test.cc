#include "workspace/find_workspace.h"

#include "tests/formats/test_files.h"

namespace colmap_ext::expect_outputs_test {

namespace fs = std::filesystem;

class ExpectOutputsTest : public FolderTest {
 protected:
  void SetUp() override {
    for (const char* name :
         {"fused.ply", "fused.ply.vis", "images/a/0.png", "stereo/fusion.cfg",
          "sparse/0/cameras.bin", "sparse/0/mesh.ply"}) {
      WriteFile(path_ / name, "");
    }
  }

  void ExpectRefused(const std::vector<fs::path>& outputs,
                     const std::string& message) const {
    ExpectFileError(message, [&] {
      ExpectOutputs(outputs, WorkspaceInputs(path_, {}, {}));
    });
  }
};

TEST_F(ExpectOutputsTest, RefusesToReplaceInputs) {
  fs::create_symlink(path_ / "fused.ply", path_ / "link.ply");
  for (const char* name :
       {"fused.ply", "fused.ply.vis", "images/../fused.ply", "link.ply",
        "images/a/0.png", "stereo/fusion.cfg", "sparse/0/cameras.bin"}) {
    SCOPED_TRACE(name);
    ExpectRefused({{}, path_ / "new.ply", path_ / name},
                  "it is read, and would be replaced");
  }
}

TEST_F(ExpectOutputsTest, RefusesTwoOutputsOfOneName) {
  for (const char* name : {"new.ply", "images/../new.ply"}) {
    ExpectRefused({path_ / name, path_ / "new.ply"}, "two outputs");
  }
}

TEST_F(ExpectOutputsTest, AllowsNewFilesAndEarlierOutputs) {
  WriteFile(path_ / "old.ply", "");
  EXPECT_NO_THROW(
      ExpectOutputs({path_ / "old.ply", path_ / "new.ply",
                     path_ / "images/new.png", path_ / "sparse/0/mesh.ply"},
                    WorkspaceInputs(path_, {}, {})));
  EXPECT_NO_THROW(ExpectOutputs({path_ / "fused.ply"},
                                WorkspaceInputs(path_, path_ / "old.ply", {})));
}

}  // namespace colmap_ext::expect_outputs_test
