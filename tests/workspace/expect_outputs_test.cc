#include "workspace/expect_outputs.h"

#include "tests/formats/test_files.h"

namespace colmap_ext::expect_outputs_test {

namespace fs = std::filesystem;

class ExpectOutputsTest : public testing::Test {
 protected:
  void SetUp() override {
    for (const char* name :
         {"fused.ply", "fused.ply.vis", "images/a/0.png", "stereo/fusion.cfg",
          "sparse/0/cameras.bin", "sparse/0/mesh.ply"}) {
      WriteFile(path_ / name, "");
    }
  }

  std::string ErrorOf(const std::vector<fs::path>& outputs) const {
    return FileErrorOf(
        [&] { ExpectOutputs(outputs, WorkspaceInputs(path_, {}, {})); });
  }

  TemporaryFolder folder_;
  const fs::path& path_ = folder_.Path();
};

TEST_F(ExpectOutputsTest, RefusesToReplaceInputs) {
  fs::create_symlink(path_ / "fused.ply", path_ / "link.ply");
  for (const char* name :
       {"fused.ply", "fused.ply.vis", "images/../fused.ply", "link.ply",
        "images/a/0.png", "stereo/fusion.cfg", "sparse/0/cameras.bin"}) {
    const std::string error = ErrorOf({{}, path_ / "new.ply", path_ / name});
    EXPECT_NE(error.find("it is read, and would be replaced"),
              std::string::npos)
        << name << ": " << error;
  }
}

TEST_F(ExpectOutputsTest, RefusesTwoOutputsOfOneName) {
  for (const char* name : {"new.ply", "images/../new.ply"}) {
    EXPECT_NE(ErrorOf({path_ / name, path_ / "new.ply"}).find("two outputs"),
              std::string::npos);
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
