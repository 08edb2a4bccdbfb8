// facetwise_refiner interrupted, and gone on with.

#include <sys/wait.h>

#include <csignal>

#include "tests/colmap_ext/refiner_fixture.h"

namespace colmap_ext::resume_test {

namespace fs = std::filesystem;

struct ResumeTest : RefinerFixture {
  // In a workspace where there is an output already.
  int Interrupt(const std::string& options, const std::string& text,
                const std::vector<int>& signals) const {
    WriteFile(path_ / kOutput, kEarlierOutput);
    return RefinerFixture::Interrupt(Workspace() + options, text, signals);
  }

  // Of a run that is interrupted at the second level.
  void InterruptAtTheSecondLevel(const std::string& options = "") const {
    const int status = Interrupt(options, "1/2 size, iteration 0", {SIGINT});
    ASSERT_TRUE(WIFEXITED(status));
    ASSERT_EQ(WEXITSTATUS(status), 130) << ErrorOutput();
  }
};

TEST_F(ResumeTest, GoesOnAfterAnInterruption) {
  const fs::path output = path_ / kOutput;
  Succeed(Refine(Option("report_path", "steps.csv")));
  const auto num_steps = [this] {
    return Count(ReadFile(path_ / "steps.csv"), "\n");
  };
  const auto num_steps_of_all = num_steps();
  const std::string mesh = BytesOf(output);
  const fs::path state = path_ / "meshed-refined.ply.resume";
  InterruptAtTheSecondLevel();
  EXPECT_TRUE(Has(ErrorOutput(), "--resume 1"));
  EXPECT_EQ(ReadFile(output), kEarlierOutput);
  const fs::path level_mesh = path_ / "meshed-refined.level2.ply";
  EXPECT_TRUE(Has(ErrorOutput(), level_mesh.string()));
  ExpectGoodMesh(level_mesh);
  ExpectRefusal(Refine(" --resume 1 @iterations 3"),
                "iterations was '10' and is '3'");
  const std::string state_bytes = ReadFile(state);
  const std::vector<Eigen::Vector3f> vertices =
      ReadPlyMesh(level_mesh).vertices;
  const size_t num_bytes = vertices.size() * sizeof(Eigen::Vector3f);
  ASSERT_GT(num_bytes, 0);
  EXPECT_NE(state_bytes.find(
                {reinterpret_cast<const char*>(vertices.data()), num_bytes}),
            std::string::npos);
  WriteFile(state, state_bytes.substr(0, state_bytes.size() - 8));
  ExpectRefusal(Refine(" --resume 1"), "damaged");
  WriteFile(state, state_bytes);
  EXPECT_TRUE(Has(
      Succeed(Refine(" --resume 1" + Option("report_path", "steps.csv"))).out,
      "continues after"));
  EXPECT_TRUE(BytesOf(output) == mesh);
  EXPECT_FALSE(fs::exists(state));
  EXPECT_FALSE(fs::exists(level_mesh));
  EXPECT_FALSE(fs::exists(VisibilityPath(level_mesh)));
  EXPECT_EQ(num_steps(), num_steps_of_all);
}

TEST_F(ResumeTest, GoesOnWithTheCamerasAsTheyWereRefined) {
  const std::string poses = " @refine_cameras poses";
  const auto results = [this] {
    std::string bytes = ReadFile(path_ / kOutput);
    for (const char* name : {"cameras.bin", "images.bin", "points3D.bin"}) {
      bytes += ReadFile(path_ / "sparse-refined" / name);
    }
    return bytes;
  };
  Succeed(Refine(poses));
  const std::string expected = results();
  fs::remove_all(path_ / "sparse-refined");
  InterruptAtTheSecondLevel(poses);
  EXPECT_FALSE(fs::exists(path_ / "sparse-refined" / "images.bin"));
  EXPECT_TRUE(
      Has(Succeed(Refine(poses + " --resume 1")).out, "continues after"));
  EXPECT_TRUE(results() == expected);
}

TEST_F(ResumeTest, RefusesToGoOnInAnotherOrderOfTheImages) {
  InterruptAtTheSecondLevel();
  // Images are in the order that this COLMAP's stereo_fusion counts them by.
#if COLMAP_EXT_COLMAP_VERSION >= 31200
  ExpectRefusal(Refine(" --resume 1 --image_order file"),
                "image_order was 'image_id' and is 'file'");
#else
  ExpectRefusal(Refine(" --resume 1 --image_order image_id"),
                "image_order was 'file' and is 'image_id'");
#endif
}

TEST_F(ResumeTest, StartsWhereThereIsNothingToGoOnFrom) {
  EXPECT_TRUE(Has(Succeed(Refine(" --resume 1 @levels 1")).out,
                  "starts from the beginning"));
}

TEST_F(ResumeTest, WritesNothingBeforeTheFirstLevelIsComplete) {
  WriteFile(path_ / kOutput, kEarlierOutput);
  const std::string before = List(path_);
  int status = Interrupt(" @levels 1", "iteration 0", {SIGTERM});
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 143);
  EXPECT_TRUE(Has(ErrorOutput(), "nothing was written"));
  EXPECT_EQ(List(path_), before);
  // The second signal ends it at once.
  status = Interrupt(" @levels 1", "iteration 0", {SIGINT, SIGTERM});
  ASSERT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(List(path_), before);
}

}  // namespace colmap_ext::resume_test
