#include "workspace/sparse_model.h"

#include <algorithm>
#include <sstream>

#include "tests/workspace/sphere_workspace.h"
#include "workspace/image_order.h"
#include "workspace/workspace.h"

namespace colmap_ext::sparse_model_test {

struct SparseModelTest : FolderTest {
  void ExpectRefused(const std::string& message) {
    ExpectFileError(message, [this] { ReadSparseModel(path_); });
  }

  void ExpectTheModel() {
    const SparseModel model = ReadSparseModel(path_);
    ASSERT_EQ(model.cameras.size(), 1);
    EXPECT_EQ(model.cameras.at(7).width, 80);
    EXPECT_EQ(model.cameras.at(7).fx, 90);
    EXPECT_EQ(model.cameras.at(7).cy, 30);
    EXPECT_TRUE(model.cameras.at(7).is_pinhole);
    ASSERT_EQ(model.images.size(), 3);
    for (size_t i = 0; i < 3; ++i) {
      const View& view = sphere_.images[i].view;
      EXPECT_EQ(model.images[i].image_id, sphere_.images[i].image_id);
      EXPECT_EQ(model.images[i].name, view.name);
      EXPECT_TRUE(
          model.images[i].cam_from_world_rotation.toRotationMatrix().isApprox(
              view.cam_from_world_rotation));
      EXPECT_TRUE(model.images[i].cam_from_world_translation.isApprox(
          view.cam_from_world_translation));
    }
    ASSERT_EQ(model.point_positions.size(), 2);
    EXPECT_TRUE(model.point_positions[1].isApprox(sphere_.points[10]));
    EXPECT_EQ(model.point_colors[1],
              SphereColor(sphere_.points[10].cast<double>()));
    EXPECT_EQ(model.track_image_ids.offsets, (std::vector<uint64_t>{0, 2, 4}));
    EXPECT_EQ(model.track_image_ids.values,
              (std::vector<uint32_t>{4, 2, 4, 2}));
    ASSERT_EQ(model.frames.size(), 2);
    EXPECT_EQ(model.frames[0].image_ids, (std::vector<uint32_t>{2, 4}));
    EXPECT_EQ(model.frames[1].image_ids, (std::vector<uint32_t>{9}));
  }

  const SphereWorkspace sphere_ = SphereWorkspace::Small();
};

TEST_F(SparseModelTest, ReadsTextOrPrefersBinaryAsColmapDoes) {
  sphere_.WriteModel(path_, ".txt");
  ExpectTheModel();
  WriteFile(path_ / "cameras.txt", "nonsense");
  sphere_.WriteModel(path_, ".bin");
  ExpectTheModel();
}

TEST_F(SparseModelTest, RefusesEveryTruncationOfBinaryAndMoreBytes) {
  sphere_.WriteModel(path_, ".bin");
  for (const char* name :
       {"cameras.bin", "images.bin", "points3D.bin", "frames.bin"}) {
    ExpectEveryTruncationRefused(path_ / name, 0,
                                 [this] { ReadSparseModel(path_); });
  }
  WriteFile(path_ / "images.bin", sphere_.ModelFile("images.bin") + "x");
  ExpectRefused("1 bytes more");
}

// Whatever is left of a text file, it is read or refused.
TEST_F(SparseModelTest, SurvivesEveryTruncationOfText) {
  sphere_.WriteModel(path_, ".txt");
  for (const char* name :
       {"cameras.txt", "images.txt", "points3D.txt", "frames.txt"}) {
    const std::string bytes = ReadFile(path_ / name);
    size_t num_refused = 0;
    for (size_t size = 0; size < bytes.size(); ++size) {
      WriteFile(path_ / name, bytes.substr(0, size));
      try {
        ReadSparseModel(path_);
      } catch (const FileError&) {
        ++num_refused;
      }
    }
    EXPECT_GT(num_refused, bytes.size() / 20) << name;
    WriteFile(path_ / name, bytes);
  }
}

TEST_F(SparseModelTest, RefusesImagesWithoutCameraTwinsAndUnknownCameraModels) {
  sphere_.WriteModel(path_, ".txt");
  WriteFile(path_ / "images.txt", "1 1 0 0 0 0 0 0 3 a.png\n\n");
  ExpectRefused("camera 3");
  const std::string twin = "1 1 0 0 0 0 0 0 7 a.png\n\n";
  WriteFile(path_ / "images.txt", twin + twin);
  ExpectRefused("image 1 is there twice");
  sphere_.WriteModel(path_, ".txt");
  const std::string frame = " 1 1 0 0 0 7 8 9 1 CAMERA 7 4\n";
  WriteFile(path_ / "frames.txt", "10" + frame + "11" + frame);
  ExpectRefused("image 4 is in its frames twice");
  sphere_.WriteModel(path_, ".txt");
  WriteFile(path_ / "cameras.txt", "7 NEW_ONE 80 60 90 40 30 0.1\n");
  ExpectRefused("NEW_ONE");
  ExpectRefused("image_undistorter");
}

TEST_F(SparseModelTest, KnowsColmapsCameraModels) {
  EXPECT_EQ(FindCameraModel(0), FindCameraModel("SIMPLE_PINHOLE"));
  EXPECT_EQ(FindCameraModel(-1), nullptr);
  EXPECT_EQ(FindCameraModel(1000), nullptr);
  sphere_.WriteModel(path_, ".txt");
  WriteFile(path_ / "cameras.txt", "7 SIMPLE_RADIAL 80 60 90 40 30 0.1\n");
  const SparseCamera camera = ReadSparseModel(path_).cameras.at(7);
  EXPECT_FALSE(camera.is_pinhole);
  EXPECT_EQ(camera.fy, 90);
  EXPECT_EQ(camera.cx, 40);
  EXPECT_EQ(camera.cy, 30);
}

// The ids and parameters of COLMAP 4.1's sensor/models.h.
TEST_F(SparseModelTest, ReadsTheCameraModelsOfColmap4) {
  const std::string binary = sphere_.ModelFile("cameras.bin");
  int model_id = 12;
  for (const auto& [name, params] :
       {std::pair("SIMPLE_DIVISION", "90 40 30 0.1"),
        std::pair("DIVISION", "90 91 40 30 0.1"),
        std::pair("SIMPLE_FISHEYE", "90 40 30"),
        std::pair("FISHEYE", "90 91 40 30"),
        std::pair("EUCM", "90 91 40 30 0.5 1.1"),
        std::pair("EQUIRECTANGULAR", "80 60")}) {
    sphere_.WriteModel(path_ / "text", ".txt");
    sphere_.WriteModel(path_, ".bin");
    WriteFile(path_ / "text" / "cameras.txt",
              std::string("7 ") + name + " 80 60 " + params + "\n");
    const SparseCamera camera = ReadSparseModel(path_ / "text").cameras.at(7);
    EXPECT_EQ(camera.model_name, name);
    EXPECT_FALSE(camera.is_pinhole);
    EXPECT_EQ(camera.cx, camera.has_focal_length ? 40 : 0);
    std::string bytes = binary.substr(0, 8 + 4);  // a count and an id
    Append(int32_t{model_id++}, &bytes);
    bytes += binary.substr(8 + 4 + 4, 16);  // the size
    std::istringstream numbers(params);
    for (double number = 0; numbers >> number;) {
      Append(number, &bytes);
    }
    WriteFile(path_ / "cameras.bin", bytes);
    EXPECT_EQ(ReadSparseModel(path_).cameras.at(7).model_name, name);
  }
}

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
  const Eigen::Quaterniond rotation =
      Eigen::Quaterniond(1, 0.1, 0.2, 0.3).normalized();
  // Two cameras, something that is none, and a camera without a pose.
  model->rigs = {{1,
                  {{0, 7},
                   {0, 8, 1, rotation, {1, 2, 3}},
                   {1, 2, 1, rotation.conjugate(), {4, 5, 6}},
                   {0, 9}}},
                 {2, {}}};
  SparseFrame& frame = model->frames.emplace_back();
  frame.frame_id = 10;
  frame.rig_id = 1;
  frame.rig_from_world_rotation = rotation;
  frame.rig_from_world_translation = {7, 8, 9};
  for (uint32_t i = 0; i < 2; ++i) {
    const uint32_t image_id = model->images[i].image_id;
    frame.image_ids.push_back(image_id);
    frame.data.push_back({0, 7 + i, image_id});
  }
  model->frames.push_back({11, {}, 2, rotation, {1, 0, 0}, {{1, 2, 77}}});
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
    EXPECT_EQ(a.images[i].observations, b.images[i].observations);
  }
  EXPECT_EQ(a.point_ids, b.point_ids);
  EXPECT_EQ(a.exact_positions, b.exact_positions);
  EXPECT_EQ(a.track_image_ids, b.track_image_ids);
  EXPECT_EQ(a.track_observations, b.track_observations);
  ASSERT_EQ(a.frames.size(), b.frames.size());
  for (size_t i = 0; i < a.frames.size(); ++i) {
    EXPECT_EQ(a.frames[i].frame_id, b.frames[i].frame_id);
    EXPECT_EQ(a.frames[i].rig_id, b.frames[i].rig_id);
    EXPECT_EQ(a.frames[i].image_ids, b.frames[i].image_ids);
    EXPECT_TRUE(a.frames[i].rig_from_world_rotation.isApprox(
        b.frames[i].rig_from_world_rotation, 1e-15));
    EXPECT_EQ(a.frames[i].rig_from_world_translation,
              b.frames[i].rig_from_world_translation);
  }
  ASSERT_EQ(a.rigs.size(), b.rigs.size());
  for (size_t i = 0; i < a.rigs.size(); ++i) {
    EXPECT_EQ(a.rigs[i].rig_id, b.rigs[i].rig_id);
    ASSERT_EQ(a.rigs[i].sensors.size(), b.rigs[i].sensors.size());
    for (size_t k = 0; k < a.rigs[i].sensors.size(); ++k) {
      const SparseSensor& sensor = a.rigs[i].sensors[k];
      const SparseSensor& expected = b.rigs[i].sensors[k];
      EXPECT_EQ(sensor.sensor_type, expected.sensor_type);
      EXPECT_EQ(sensor.sensor_id, expected.sensor_id);
      EXPECT_EQ(sensor.has_pose, expected.has_pose);
      EXPECT_TRUE(sensor.rotation.isApprox(expected.rotation, 1e-15));
      EXPECT_EQ(sensor.translation, expected.translation);
    }
  }
}

TEST_F(WriteSparseModelTest, IsReadBackAsItWasWithNoFramesOfAnotherModel) {
  const std::filesystem::path path = path_ / "sparse-refined";
  SparseModel model = MakeModel();
  WriteSparseModel(path, model);
  ExpectSame(ReadSparseModel(path, SparseDetail::kAll), model);
  AddFrames(&model);
  WriteSparseModel(path, model);
  ExpectSame(ReadSparseModel(path, SparseDetail::kAll), model);
  WriteSparseModel(path, MakeModel());
  EXPECT_EQ(List(path), "cameras.bin images.bin points3D.bin");
}

TEST_F(WriteSparseModelTest, ReadsRigsOfTextToo) {
  for (const std::string name : {"cameras", "images", "points3D"}) {
    WriteFile(path_ / "text" / (name + ".txt"),
              name == "cameras" ? "7 PINHOLE 640 480 500 501 320 240\n" : "");
  }
  WriteFile(path_ / "text" / "frames.txt",
            "# frames\n10 1 1 0 0 0 7 8 9 1 CAMERA 7 3\n");
  EXPECT_THROW(ReadSparseModel(path_ / "text", SparseDetail::kAll), FileError);
  WriteFile(path_ / "text" / "rigs.txt",
            "1 3 CAMERA 7 CAMERA 8 1 1 0 0 0 1 2 3 IMU 2 0\n");
  const SparseModel read = ReadSparseModel(path_ / "text", SparseDetail::kAll);
  ASSERT_EQ(read.rigs.size(), 1);
  ASSERT_EQ(read.rigs[0].sensors.size(), 3);
  EXPECT_EQ(read.rigs[0].sensors[1].translation, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(read.rigs[0].sensors[2].sensor_type, 1);
  EXPECT_EQ(read.rigs[0].sensors[2].has_pose, 0);
  EXPECT_EQ(read.frames[0].rig_from_world_translation,
            Eigen::Vector3d(7, 8, 9));
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

using Indices = std::vector<size_t>;

struct ImageOrderTest : FolderTest {
  // The order that is found in a workspace whose .vis counts as vis_order.
  VerifiedOrder Find(const Indices& vis_order,
                     std::optional<ImageOrderKind> wanted = std::nullopt) {
    sphere_.vis_order = vis_order;
    std::filesystem::remove_all(path_ / "sparse");
    sphere_.Write(path_);
    const SparseModel model = ReadSparseModel(path_ / "sparse");
    const PlyCloud cloud = ReadPlyCloud(path_ / "fused.ply");
    const Visibility visibility =
        ReadVisibility(path_ / "fused.ply.vis", cloud.positions.size());
    const Views views = ReadViews(path_, model, {}, decoder_);
    return FindImageOrder({cloud, visibility, model, views.views,
                           path_ / "images", decoder_, path_ / "fused.ply.vis"},
                          wanted);
  }

  template <typename Function>
  static std::optional<Alternative> AlternativeTo(Function function) {
    try {
      function();
    } catch (const FileError& error) {
      return error.GetAlternative();
    }
    return std::nullopt;
  }

  // The images have the ids 4, 9, 2, 7, 5, 1, 8, in the order of the file.
  const Indices file_order_ = {0, 1, 2, 3, 4, 5, 6};
  const Indices id_order_ = {5, 2, 0, 4, 3, 6, 1};
  PictureDecoder decoder_ = NetpbmDecoder();
  SphereWorkspace sphere_;
};

TEST_F(ImageOrderTest, FindsTheOrderOfEachVersionOfColmap) {
  const VerifiedOrder file = Find(file_order_);
  EXPECT_EQ(file.order.kind, ImageOrderKind::kFile);
  EXPECT_EQ(file.order.images, file_order_);
  EXPECT_EQ(file.evidence.inside, 1);
  EXPECT_EQ(file.evidence.facing, 1);
  const VerifiedOrder by_id = Find(id_order_);
  EXPECT_EQ(by_id.order.kind, ImageOrderKind::kImageId);
  EXPECT_EQ(by_id.order.images, id_order_);

  sphere_.frames = {{8, 4}, {9, 7, 1}, {2}, {5}};
  const Indices frame_order = {6, 0, 1, 3, 5, 2, 4};
  EXPECT_EQ(Find(frame_order).order.kind, ImageOrderKind::kFrame);
  EXPECT_EQ(Find(frame_order).order.images, frame_order);
  EXPECT_EQ(Find(id_order_).order.kind, ImageOrderKind::kImageId);
}

TEST_F(ImageOrderTest, FindsItByColorsWhereNormalsAreMissing) {
  sphere_.write_normals = false;
  for (const Indices& order : {file_order_, id_order_}) {
    const VerifiedOrder found = Find(order);
    EXPECT_EQ(found.order.images, order);
    EXPECT_EQ(found.reason, OrderReason::kColors);
  }
}

TEST_F(ImageOrderTest, RefusesToGuess) {
  sphere_.write_normals = false;
  sphere_.write_images = false;
  EXPECT_EQ(AlternativeTo([&] { Find(id_order_); }),
            Alternative::kSayImageOrder);
  const VerifiedOrder wanted = Find(id_order_, ImageOrderKind::kImageId);
  EXPECT_EQ(wanted.order.images, id_order_);
  EXPECT_EQ(wanted.reason, OrderReason::kWanted);
  EXPECT_EQ(AlternativeTo([&] { Find(id_order_, ImageOrderKind::kFrame); }),
            Alternative::kOtherImageOrder);
}

TEST_F(ImageOrderTest, RefusesTheVisibilityOfAnotherModel) {
  for (Eigen::Vector3f& point : sphere_.points) {
    point += Eigen::Vector3f(0, 0, 2);
  }
  ExpectFileError("another model", [&] { Find(file_order_); });
  ExpectFileError("another model",
                  [&] { Find(file_order_, ImageOrderKind::kFile); });
}

TEST_F(ImageOrderTest, AsksNothingWhereAllOrdersAreTheSame) {
  std::ranges::sort(sphere_.images, {}, &SphereWorkspace::Image::image_id);
  // The points were fused to other images, but all of them see the centre.
  sphere_.write_normals = false;
  sphere_.write_images = false;
  EXPECT_EQ(Find(file_order_).reason, OrderReason::kOnlyOne);
}

}  // namespace colmap_ext::sparse_model_test
