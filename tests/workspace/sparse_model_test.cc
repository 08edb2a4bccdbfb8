#include "workspace/sparse_model.h"

#include <algorithm>
#include <sstream>

#include "tests/formats/test_files.h"
#include "tests/workspace/sphere_workspace.h"

namespace colmap_ext::sparse_model_test {

class SparseModelTest : public FolderTest {
 protected:
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

TEST_F(SparseModelTest, RefusesEveryTruncationOfBinary) {
  sphere_.WriteModel(path_, ".bin");
  for (const char* name :
       {"cameras.bin", "images.bin", "points3D.bin", "frames.bin"}) {
    ExpectEveryTruncationRefused(path_ / name, 0,
                                 [this] { ReadSparseModel(path_); });
  }
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

TEST_F(SparseModelTest, RefusesTrailingBytes) {
  sphere_.WriteModel(path_, ".bin");
  WriteFile(path_ / "images.bin", sphere_.ModelFile("images.bin") + "x");
  ExpectRefused("1 bytes more");
}

TEST_F(SparseModelTest, RefusesImagesWithoutCameraAndTwins) {
  sphere_.WriteModel(path_, ".txt");
  WriteFile(path_ / "images.txt", "1 1 0 0 0 0 0 0 3 a.png\n\n");
  ExpectRefused("camera 3");
  const std::string twin = "1 1 0 0 0 0 0 0 7 a.png\n\n";
  WriteFile(path_ / "images.txt", twin + twin);
  ExpectRefused("twice");
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

TEST_F(SparseModelTest, NamesUnknownCameraModelsAndWhatToDo) {
  sphere_.WriteModel(path_, ".txt");
  WriteFile(path_ / "cameras.txt", "7 NEW_ONE 80 60 90 40 30 0.1\n");
  ExpectRefused("NEW_ONE");
  ExpectRefused("image_undistorter");
}

}  // namespace colmap_ext::sparse_model_test
