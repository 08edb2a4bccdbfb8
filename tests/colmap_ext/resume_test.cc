// facetwise_refiner interrupted, and gone on with.

#include <sys/wait.h>

#include <csignal>
#include <utility>

#include "tests/colmap_ext/process.h"
#include "tests/colmap_ext/refiner_fixture.h"

namespace colmap_ext {
namespace resume_test {

namespace fs = std::filesystem;

class ResumeTest : public RefinerFixture {
 protected:
  // Runs the program in a workspace where there is an output already, and sends
  // it signals, one after the other, when it has printed the text.
  // \return as waitpid() has it.
  int Interrupt(const std::vector<std::string>& more_arguments,
                const std::string& text,
                const std::vector<int>& signals) const {
    WriteFile(path_ / kOutput, kEarlierOutput);
    std::vector<std::string> arguments = {
        "facetwise_refiner", "--FacetwiseRefinement.backend", "cpu",
        "--workspace_path", path_.string()};
    arguments.insert(arguments.end(), more_arguments.begin(),
                     more_arguments.end());
    Process process(kProgram, arguments, folder_.Path() / "err");
    EXPECT_TRUE(process.WaitFor(text)) << ErrorOutput();
    for (const int number : signals) {
      process.Signal(number);
    }
    return process.Wait();
  }

  // Of a run that is interrupted at the second level.
  void InterruptAtTheSecondLevel(
      const std::vector<std::string>& more_arguments = {}) const {
    const int status =
        Interrupt(more_arguments, "1/2 size, iteration 0", {SIGINT});
    ASSERT_TRUE(WIFEXITED(status));
    ASSERT_EQ(WEXITSTATUS(status), 130) << ErrorOutput();
  }

  // As Interrupt() makes it.
  std::string ListWithEarlierOutput() const {
    WriteFile(path_ / kOutput, kEarlierOutput);
    return List(path_);
  }

  void ExpectResumeRefused(const std::string& message) const {
    ExpectRefusal(Run(Workspace() + " --resume 1"), message);
  }

  std::string ErrorOutput() const { return ReadFile(folder_.Path() / "err"); }
};

TEST_F(ResumeTest, GoesOnAfterAnInterruption) {
  const fs::path output = path_ / kOutput;
  ASSERT_EQ(Run(Workspace() + Option("report_path", "steps.csv")).exit_code, 0);
  const auto num_steps = [this] {
    const std::string csv = ReadFile(path_ / "steps.csv");
    return std::count(csv.begin(), csv.end(), '\n');
  };
  const auto num_steps_of_all = num_steps();
  const std::string mesh = ReadFile(output);
  const std::string visibility = ReadFile(VisibilityPath(output));
  const fs::path state = path_ / "meshed-refined.ply.resume";
  InterruptAtTheSecondLevel();
  EXPECT_NE(ErrorOutput().find("--resume 1"), std::string::npos);
  EXPECT_EQ(ReadFile(output), kEarlierOutput);
  const fs::path level_mesh = path_ / "meshed-refined.level2.ply";
  EXPECT_NE(ErrorOutput().find(level_mesh.string()), std::string::npos);
  ExpectGoodMesh(level_mesh);
  ExpectRefusal(
      Run(Workspace() + " --resume 1 --FacetwiseRefinement.iterations 3"),
      "iterations was '10' and is '3'");
  const std::string state_bytes = ReadFile(state);
  WriteFile(state, state_bytes.substr(0, state_bytes.size() - 8));
  ExpectResumeRefused("damaged");
  WriteFile(state, state_bytes);
  const Outcome outcome =
      Run(Workspace() + " --resume 1" + Option("report_path", "steps.csv"));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("goes on after"), std::string::npos);
  EXPECT_TRUE(ReadFile(output) == mesh);
  EXPECT_TRUE(ReadFile(VisibilityPath(output)) == visibility);
  EXPECT_FALSE(fs::exists(state));
  EXPECT_FALSE(fs::exists(level_mesh));
  EXPECT_FALSE(fs::exists(VisibilityPath(level_mesh)));
  EXPECT_EQ(num_steps(), num_steps_of_all);
}

TEST_F(ResumeTest, GoesOnWithTheCamerasAsTheyWereRefined) {
  const std::vector<std::string> poses = {
      "--FacetwiseRefinement.refine_cameras", "poses"};
  const std::string options = Workspace() + " " + poses[0] + " " + poses[1];
  const auto results = [this] {
    std::string bytes = ReadFile(path_ / kOutput);
    for (const char* name : {"cameras.bin", "images.bin", "points3D.bin"}) {
      bytes += ReadFile(path_ / "sparse-refined" / name);
    }
    return bytes;
  };
  ASSERT_EQ(Run(options).exit_code, 0);
  const std::string expected = results();
  fs::remove_all(path_ / "sparse-refined");
  InterruptAtTheSecondLevel(poses);
  EXPECT_FALSE(fs::exists(path_ / "sparse-refined" / "images.bin"));
  const Outcome outcome = Run(options + " --resume 1");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("goes on after"), std::string::npos);
  EXPECT_TRUE(results() == expected);
}

// What the mesh depends on has to be the same.
TEST_F(ResumeTest, RefusesToGoOnWithOtherPosesOrPictures) {
  InterruptAtTheSecondLevel();
  // The last binary digit of a focal length, a translation and a coordinate,
  // and a colour.
  for (const auto& [name, position] :
       {std::pair("sparse/cameras.bin", 32), std::pair("sparse/images.bin", 44),
        std::pair("sparse/points3D.bin", 16), std::pair("fused.ply", -1)}) {
    const std::string bytes = ReadFile(path_ / name);
    std::string other = bytes;
    char& byte = position < 0 ? other.back() : other[position];
    byte = static_cast<char>(byte ^ 1);
    WriteFile(path_ / name, other);
    ExpectResumeRefused(name);
    WriteFile(path_ / name, bytes);
  }
  const fs::path picture = path_ / "images" / "0003.png";
  const std::string bytes = ReadFile(picture);
  WriteFile(picture, bytes + "x");  // which decoders do not read
  ExpectResumeRefused("images/0003.png");
  WriteFile(picture, bytes);
  EXPECT_EQ(Run(Workspace() + " --resume 1").exit_code, 0);
}

TEST_F(ResumeTest, RefusesToGoOnInAnotherOrderOfTheImages) {
  InterruptAtTheSecondLevel();
  // Images are in the order that this COLMAP's stereo_fusion counts them by.
#if COLMAP_EXT_COLMAP_VERSION >= 31200
  ExpectRefusal(Run(Workspace() + " --resume 1 --image_order file"),
                "image_order was 'image_id' and is 'file'");
#else
  ExpectRefusal(Run(Workspace() + " --resume 1 --image_order image_id"),
                "image_order was 'file' and is 'image_id'");
#endif
}

TEST_F(ResumeTest, StartsWhereThereIsNothingToGoOnFrom) {
  const Outcome outcome =
      Run(Workspace() + " --resume 1 --FacetwiseRefinement.levels 1");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("starts from the beginning"), std::string::npos);
}

TEST_F(ResumeTest, WritesNothingBeforeTheFirstLevelIsComplete) {
  const std::string before = ListWithEarlierOutput();
  const int status = Interrupt({"--FacetwiseRefinement.levels", "1"},
                               "iteration 0", {SIGTERM});
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 143);
  EXPECT_NE(ErrorOutput().find("nothing was written"), std::string::npos);
  EXPECT_EQ(List(path_), before);
}

TEST_F(ResumeTest, EndsAtOnceAtTheSecondSignal) {
  const std::string before = ListWithEarlierOutput();
  const int status = Interrupt({"--FacetwiseRefinement.levels", "1"},
                               "iteration 0", {SIGINT, SIGTERM});
  ASSERT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(List(path_), before);
}

}  // namespace resume_test
}  // namespace colmap_ext
