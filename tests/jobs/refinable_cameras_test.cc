#include <gtest/gtest.h>

#include "colmap_ext/jobs/refinement_input.h"
#include "tests/formats/test_files.h"
#include "workspace/sparse_model.h"

namespace colmap_ext::refinable_cameras_test {

// Two images of 400 x 300 px, the second with an observation of the only point.
SparseModel MakeModel() {
  SparseModel model;
  model.cameras[1] = {"PINHOLE", 400, 300, 500, 500, 200, 150, true};
  model.images.resize(2);
  for (uint32_t i = 0; i < 2; ++i) {
    model.images[i].image_id = i + 1;
    model.images[i].camera_id = 1;
    model.images[i].name = i == 0 ? "a.png" : "b.png";
  }
  model.images[1].observations = {{{100, 75}, 3}};
  model.point_positions = {{0, 0, 2}};
  model.point_colors = {{1, 2, 3}};
  model.track_image_ids = Rows<uint32_t>({0, 1}, {2});
  model.point_ids = {3};
  model.exact_positions = {{0, 0, 2}};
  model.track_observations = {0};
  return model;
}

// At half the size, in the other order.
std::vector<View> MakeViews() {
  View view{"b.png", 200, 150};
  view.fx = view.fy = 250;
  view.cx = 100;
  view.cy = 75;
  std::vector<View> views(2, view);
  views[1].name = "a.png";
  return views;
}

struct RefinableCamerasTest : FolderTest {
  RefinableCamerasTest() { WriteSparseModel(path_, MakeModel()); }
};

TEST_F(RefinableCamerasTest, HaveTheTracksInTheViewsPixels) {
  const auto cameras = ReadRefinableCameras(path_, MakeViews(), nullptr);
  ASSERT_EQ(cameras->tracks.observations.values.size(), 1);
  const auto& observation = cameras->tracks.observations.values[0];
  EXPECT_EQ(observation.view, 0);
  EXPECT_EQ(observation.pixel, Eigen::Vector2d(50, 37.5));
  EXPECT_EQ(cameras->view_cameras, std::vector<uint32_t>({0, 0}));
}

TEST_F(RefinableCamerasTest, AreWrittenToTheImagesOfTheirNames) {
  std::vector<View> views = MakeViews();
  views[0].fx = 255;
  views[0].cam_from_world_translation = {1, 2, 3};
  WriteRefinedCameras(path_ / "refined", RefinedParts::kPoses, path_, views,
                      {{0, 0, 2.5}});
  const SparseModel refined =
      ReadSparseModel(path_ / "refined", SparseDetail::kAll);
  EXPECT_EQ(refined.images[1].cam_from_world_translation,
            Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(refined.images[0].cam_from_world_translation,
            Eigen::Vector3d(0, 0, 0));
  EXPECT_EQ(refined.images[1].observations, MakeModel().images[1].observations);
  EXPECT_EQ(refined.exact_positions[0].z(), 2.5);
  EXPECT_EQ(refined.cameras.at(1).fx, 500);
  WriteRefinedCameras(path_ / "refined", RefinedParts::kPosesIntrinsics, path_,
                      {views[0], views[0]}, {{0, 0, 2.5}});
  EXPECT_EQ(ReadSparseModel(path_ / "refined").cameras.at(1).fx, 510);
}

TEST_F(RefinableCamerasTest, RefuseAModelThatWasChangedMeanwhile) {
  const std::string changed = ": it has changed since it was read";
  const auto write = [&](const std::vector<Eigen::Vector3d>& positions) {
    WriteRefinedCameras(path_ / "refined", RefinedParts::kPoses, path_,
                        MakeViews(), positions);
  };
  ExpectFileError("has other points" + changed, [&] { write({}); });
  SparseModel model = MakeModel();
  model.images[0].name = "c.png";
  WriteSparseModel(path_, model);
  ExpectFileError("has no image a.png" + changed, [&] { write({{0, 0, 2}}); });
  EXPECT_FALSE(std::filesystem::exists(path_ / "refined"));
}

}  // namespace colmap_ext::refinable_cameras_test
