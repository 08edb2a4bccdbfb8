#include "workspace/sparse_model.h"

#include "tests/formats/test_files.h"

namespace colmap_ext::write_sparse_model_test {

using WriteSparseModelTest = FolderTest;

// Two images of one camera that see two points.
SparseModel MakeModel() {
  SparseModel model;
  model.cameras[7] = {"PINHOLE", 80, 60, 90, 91, 40, 30, true};
  for (uint32_t i = 0; i < 2; ++i) {
    SparseImage image;
    image.image_id = 4 - i;
    image.camera_id = 7;
    image.name = "sub/" + std::to_string(i) + ".png";
    image.cam_from_world_rotation =
        Eigen::Quaterniond(1, 0.1 * i, 0, 0.2).normalized();
    image.cam_from_world_translation = Eigen::Vector3d(i, 0, 3);
    image.observations = {
        {{10, 20}, kNoSparsePoint}, {{30, 40.5}, 12}, {{50, 60}, 13}};
    model.images.push_back(image);
  }
  for (uint64_t id = 12; id < 14; ++id) {
    model.point_ids.push_back(id);
    model.exact_positions.emplace_back(0.1, 1.0 / 3, id);
    model.point_positions.push_back(model.exact_positions.back().cast<float>());
    model.point_colors.push_back({1, 2, 3});
    model.track_image_ids.AddRow(std::vector<uint32_t>{4, 3});
    model.track_observations.insert(
        model.track_observations.end(),
        {static_cast<uint32_t>(id - 11), static_cast<uint32_t>(id - 11)});
  }
  return model;
}

void AddFrames(SparseModel* model) {
  model->rigs = {{1, 1, 0, 7}};
  for (uint32_t i = 0; i < 2; ++i) {
    const uint32_t image_id = model->images[i].image_id;
    model->frames.push_back({10 + i, {image_id}, 1, {{0, 7, image_id}}});
  }
}

void ExpectSame(const SparseModel& a, const SparseModel& b) {
  EXPECT_EQ(a.cameras.at(7).fy, b.cameras.at(7).fy);
  EXPECT_EQ(a.cameras.at(7).width, b.cameras.at(7).width);
  ASSERT_EQ(a.images.size(), b.images.size());
  for (size_t i = 0; i < a.images.size(); ++i) {
    EXPECT_EQ(a.images[i].image_id, b.images[i].image_id);
    EXPECT_EQ(a.images[i].name, b.images[i].name);
    EXPECT_TRUE(a.images[i].cam_from_world_rotation.isApprox(
        b.images[i].cam_from_world_rotation, 1e-15));
    EXPECT_EQ(a.images[i].cam_from_world_translation,
              b.images[i].cam_from_world_translation);
    ASSERT_EQ(a.images[i].observations.size(), b.images[i].observations.size());
    for (size_t k = 0; k < a.images[i].observations.size(); ++k) {
      EXPECT_EQ(a.images[i].observations[k].pixel,
                b.images[i].observations[k].pixel);
      EXPECT_EQ(a.images[i].observations[k].point_id,
                b.images[i].observations[k].point_id);
    }
  }
  EXPECT_EQ(a.point_ids, b.point_ids);
  EXPECT_EQ(a.exact_positions, b.exact_positions);
  EXPECT_EQ(a.track_image_ids, b.track_image_ids);
  EXPECT_EQ(a.track_observations, b.track_observations);
  EXPECT_EQ(a.frames.size(), b.frames.size());
  EXPECT_EQ(a.rigs.size(), b.rigs.size());
}

TEST_F(WriteSparseModelTest, IsReadBackAsItWas) {
  const std::filesystem::path path = path_ / "sparse-refined";
  SparseModel model = MakeModel();
  WriteSparseModel(path, model);
  ExpectSame(ReadSparseModel(path, SparseDetail::kAll), model);
  AddFrames(&model);
  WriteSparseModel(path, model);
  ExpectSame(ReadSparseModel(path, SparseDetail::kAll), model);
}

TEST_F(WriteSparseModelTest, LeavesNoFramesOfAnotherModel) {
  SparseModel model = MakeModel();
  AddFrames(&model);
  WriteSparseModel(path_, model);
  WriteSparseModel(path_, MakeModel());
  EXPECT_EQ(List(path_), "cameras.bin images.bin points3D.bin");
}

TEST_F(WriteSparseModelTest, TellsRigsOfSeveralCameras) {
  SparseModel model = MakeModel();
  EXPECT_TRUE(HasOneImageFrames(model));
  AddFrames(&model);
  EXPECT_TRUE(HasOneImageFrames(model));
  model.rigs[0].num_sensors = 2;
  EXPECT_FALSE(HasOneImageFrames(model));
}

// Where a file can not be made, those that are there stay.
TEST_F(WriteSparseModelTest, WritesAllOrNothing) {
  const SparseModel model = MakeModel();
  WriteSparseModel(path_, model);
  std::filesystem::remove(path_ / "points3D.bin");
  std::filesystem::create_directory(path_ / "points3D.bin");
  const auto before = FilesOf(path_);
  SparseModel other = model;
  other.images[0].cam_from_world_translation.x() = 5;
  EXPECT_THROW(WriteSparseModel(path_, other), FileError);
  EXPECT_EQ(FilesOf(path_), before);
}

// The points' file is the one that does not fit.
TEST_F(WriteSparseModelTest, KeepsTheOldModelWhenTheDiskIsFull) {
  SparseModel model = MakeModel();
  WriteSparseModel(path_ / "a", model);
  const auto before = FilesOf(path_);
  for (uint64_t id = 14; id < 40000; ++id) {
    model.point_ids.push_back(id);
    model.exact_positions.emplace_back(0, 0, 1);
    model.point_positions.emplace_back(0, 0, 1);
    model.point_colors.push_back({1, 2, 3});
    model.track_image_ids.AddRow(std::vector<uint32_t>{});
  }
  model.images[0].cam_from_world_translation.x() = 5;
  for (const char* name : {"a", "new"}) {
    EXPECT_TRUE(FailsOnAFullDisk(
        1 << 20, [&] { WriteSparseModel(path_ / name, model); }));
  }
  EXPECT_EQ(FilesOf(path_), before);
}

}  // namespace colmap_ext::write_sparse_model_test
