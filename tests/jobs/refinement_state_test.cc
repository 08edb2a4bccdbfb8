#include "colmap_ext/jobs/resumable_refinement.h"

#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>

#include "tests/formats/test_files.h"

namespace colmap_ext::refinement_state_test {

namespace fs = std::filesystem;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct RefinementStateTest : testing::Test {
  RefinementStateTest() {
    state_.mesh = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 1e-30F}}, {{0, 1, 2}}};
    state_.attributes.colors = {{1, 2, 3}, {4, 5, 6}, {7, 8, 255}};
    state_.attributes.views = Rows<uint32_t>({0, 2, 2, 3}, {0, 1, 1});
    state_.origins = {{0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
    state_.fixed_sources = {7, kNone, 9};
    state_.views.resize(2);
    state_.views[1].name = "b.png";
    state_.views[1].fx = 1000.1;
    state_.views[1].cam_from_world_rotation << 0, 1, 0, -1, 0, 0, 0, 0, 1;
    state_.views[1].cam_from_world_translation = {0.1, -1.0 / 3, 1e-300};
    RefinementReport& report = state_.report;
    report.num_removed_self_intersections = size_t{1} << 60;
    report.labelings = {{2, 9, 1, 0.1, 1e-300, -kInfinity}};
    report.steps.resize(2);
    report.steps[0].energy = std::nan("");
    report.steps[1].is_final = true;
    report.steps[1].photometric_energy = kInfinity;
    CameraAlignment& alignment = state_.alignment;
    alignment.misalignment = {1.0 / 3, 0.1, {0, 1e-300}, {{1.0 / 3}, {}}};
    alignment.track_positions = {{1.0 / 3, 0, 1e-300}};
    alignment.refinements.resize(1);
    alignment.refinements[0].track_sigma = 0.1;
    alignment.refinements[0].views.resize(2);
    alignment.refinements[0].views[1].motion = 1.0 / 3;
  }

  void Write(const RefinedMesh& state) const {
    WriteState(output_, inputs_, 2, state, state.report);
  }

  RefinedMesh Read() const {
    RefinedMesh read;
    read.views = state_.views;
    for (View& view : read.views) {
      view.fx = 1;
      view.cam_from_world_rotation.setIdentity();
      view.cam_from_world_translation.setZero();
    }
    EXPECT_EQ(ReadState(output_, inputs_, &read), 2);
    return read;
  }

  TemporaryFolder folder_;
  fs::path output_ = folder_.Path() / "mesh.ply";
  JobInputs inputs_ = {{{"levels", "3"}, {"region", ""}},
                       {{"images/\"a\"\n\xff.png", "none"}}};
  RefinedMesh state_;
};

TEST_F(RefinementStateTest, IsReadBackAsItWas) {
  Write(state_);
  const RefinedMesh read = Read();
  EXPECT_EQ(read.mesh.facets, state_.mesh.facets);
  EXPECT_EQ(read.attributes.views, state_.attributes.views);
  EXPECT_TRUE(read.attributes.confidences.empty());
  EXPECT_EQ(read.fixed_sources, state_.fixed_sources);
  ASSERT_EQ(read.views.size(), 2u);
  EXPECT_EQ(read.views[1].name, "b.png");
  EXPECT_EQ(read.views[1].cam_from_world_rotation,
            state_.views[1].cam_from_world_rotation);
  EXPECT_EQ(read.report.num_removed_self_intersections, size_t{1} << 60);
  ASSERT_EQ(read.report.steps.size(), 2u);
  EXPECT_TRUE(std::isnan(read.report.steps[0].energy));
  EXPECT_TRUE(read.report.steps[1].is_final);
  EXPECT_EQ(read.alignment.misalignment.by_view,
            state_.alignment.misalignment.by_view);
  EXPECT_EQ(read.alignment.misalignment.radial_shifts,
            state_.alignment.misalignment.radial_shifts);
  ASSERT_EQ(read.alignment.refinements.size(), 1u);
  EXPECT_EQ(read.alignment.refinements[0].views[1].motion, 1.0 / 3);
  // All else, by what is written of it.
  const std::string bytes = ReadFile(StatePath(output_));
  Write(read);
  EXPECT_TRUE(ReadFile(StatePath(output_)) == bytes);
  RemoveState(output_);
  EXPECT_FALSE(fs::exists(StatePath(output_)));
}

TEST_F(RefinementStateTest, NamesWhatDiffersAndRefusesDamagedFiles) {
  Write(state_);
  inputs_.options["levels"] = "2";
  ExpectFileError("levels was '3' and is '2'", [&] { Read(); });
  const std::string bytes = ReadFile(StatePath(output_));
  for (size_t at = 0; at < bytes.size(); ++at) {
    std::string other = bytes;
    other[at] = static_cast<char>(other[at] ^ 4);
    for (const std::string& damaged : {other, bytes.substr(0, at)}) {
      WriteFile(StatePath(output_), damaged);
      ExpectFileError("start without", [&] { Read(); });
    }
  }
}

TEST_F(RefinementStateTest, RefusesOlderVersionsInOneLine) {
  WriteFile(StatePath(output_),
            "{\n \"format\": \"colmap_ext facetwise_refiner resume\",\n "
            "\"version\": 6\n}\n");
  EXPECT_EQ(MessageOf<FileError>([&] { Read(); }),
            StatePath(output_).string() +
                ": of another version of the program: start without "
                "--resume");
}

}  // namespace colmap_ext::refinement_state_test
