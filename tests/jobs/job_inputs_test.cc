#include "colmap_ext/jobs/job_file.h"

#include "colmap_ext/jobs/refinement_input.h"
#include "tests/formats/test_files.h"
#include "tests/workspace/sphere_workspace.h"

namespace colmap_ext {
namespace job_inputs_test {

namespace fs = std::filesystem;

class JobInputsTest : public testing::Test {
 protected:
  JobInputsTest() {
    sphere_.Write(path_);
    WriteFile(path_ / "mesh.ply",
              "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
              "property float y\nproperty float z\nelement face 1\n"
              "property list uchar int vertex_index\nend_header\n"
              "1 0 0\n0 1 0\n0 0 1\n3 0 1 2\n");
  }

  JobInputs Inputs() const {
    RefinerOptions options = options_;
    options.workspace_path = path_.string();
    options.input_path = (path_ / "mesh.ply").string();
    options.output_path = (path_ / "refined.ply").string();
    options.Finish();
    const RefinementPaths paths = FindRefinementPaths(options);
    return RunInputs(options, paths,
                     ReadRefinementInput(options, paths, NetpbmDecoder(), {}));
  }

  // The name of what is no longer as it was; "" for nothing.
  std::string Changed() const {
    const std::string difference = Inputs().DifferenceTo(before_);
    return difference.substr(0, difference.find(" was "));
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
  JobInputs before_;
};

TEST_F(JobInputsTest, TellsWhichFileWasChanged) {
  const std::string picture = "images/" + sphere_.images[2].view.name;
  for (const auto& [name, position] :
       {std::pair<std::string, size_t>("sparse/cameras.bin", 32),
        std::pair<std::string, size_t>("sparse/images.bin", 44),
        std::pair<std::string, size_t>("sparse/points3D.bin", 16),
        std::pair<std::string, size_t>("fused.ply", 300),
        std::pair<std::string, size_t>(picture, 100)}) {
    before_ = Inputs();
    EXPECT_EQ(Changed(), "");
    ChangeByte(name, position);
    EXPECT_EQ(Changed(), name);
  }
}

TEST_F(JobInputsTest, TellsTheOptionThatWasChanged) {
  before_ = Inputs();
  options_.refinement.smoothness_weight = 0.1 + 0.2;
  EXPECT_EQ(Changed(), "FacetwiseRefinement.smoothness_weight");
  options_.refinement.smoothness_weight = 1;
  options_.num_threads = 1;
  options_.image_cache_gb = 1;
  EXPECT_EQ(Changed(), "") << "these do not change the result";
}

// Files of more than 16 MB are sampled, their ends included.
TEST(FingerprintTest, TellsFilesApart) {
  const TemporaryFolder folder;
  const fs::path path = folder.Path() / "file";
  EXPECT_EQ(Fingerprint(path), "none");
  for (const size_t size : {0, 1, 1 << 18, (16 << 20) + 1, 40 << 20}) {
    std::string bytes(size, 'a');
    WriteFile(path, bytes);
    const std::string fingerprint = Fingerprint(path);
    EXPECT_EQ(fingerprint.substr(0, fingerprint.find(' ')),
              std::to_string(size));
    EXPECT_EQ(Fingerprint(path), fingerprint);
    for (const double share : {0.0, 1.0}) {
      if (size > 0) {
        const auto at =
            static_cast<size_t>(share * static_cast<double>(size - 1));
        bytes[at] = 'b';
        WriteFile(path, bytes);
        EXPECT_NE(Fingerprint(path), fingerprint) << size << " " << share;
        bytes[at] = 'a';
      }
    }
  }
}

}  // namespace job_inputs_test
}  // namespace colmap_ext
