#include "workspace/workspace.h"

#include <limits>
#include <random>

#include "tests/workspace/sphere_workspace.h"
#include "workspace/workspace_paths.h"

namespace colmap_ext::workspace_test {

namespace fs = std::filesystem;

struct WorkspaceTest : FolderTest {
  // Of what has been written.
  Workspace Read(const WorkspaceOptions& options = {}) const {
    return ReadWorkspace(path_, options, NetpbmDecoder());
  }

  Workspace WriteAndRead() const {
    sphere_.Write(path_);
    return Read();
  }

  void ExpectRefused(const std::string& message) const {
    ExpectFileError(message, [this] { Read(); });
  }

  SphereWorkspace sphere_;
};

TEST_F(WorkspaceTest, ReadsTheSphere) {
  const Workspace workspace = WriteAndRead();
  EXPECT_EQ(workspace.report.path, path_);
  EXPECT_EQ(workspace.report.sparse_path, path_ / "sparse");
  EXPECT_EQ(workspace.report.num_missing_images, 0);
  EXPECT_EQ(workspace.report.num_rescaled_images, 0);
  ASSERT_EQ(workspace.views.size(), sphere_.images.size());
  EXPECT_EQ(workspace.views[2].name, "image2.ppm");
  EXPECT_EQ(workspace.views[2].fx, 90);
  EXPECT_TRUE(
      workspace.views[2].Center().isApprox(sphere_.images[2].view.Center()));
  ASSERT_EQ(workspace.cloud.size(), sphere_.points.size());
  EXPECT_EQ(workspace.cloud.positions[5], sphere_.points[5]);
  EXPECT_EQ(workspace.cloud.colors.size(), sphere_.points.size());
  EXPECT_EQ(workspace.cloud.views[5].size(), sphere_.point_images[5].size());
  EXPECT_EQ(workspace.sparse_points.size(), sphere_.points.size() / 10);
  EXPECT_EQ(workspace.depth_map_scales, std::vector<double>(7, 1));
}

// The views follow the .vis, so that its indices can be used as they are.
TEST_F(WorkspaceTest, OrdersViewsAsTheVisCountsThem) {
  sphere_.vis_order = {5, 2, 0, 4, 3, 6, 1};
  const Workspace workspace = WriteAndRead();
  for (size_t i = 0; i < 7; ++i) {
    EXPECT_EQ(workspace.views[i].name,
              sphere_.images[sphere_.vis_order[i]].view.name);
  }
}

TEST_F(WorkspaceTest, ReadsSparsePointsAndTheirTracks) {
  sphere_.Write(path_);
  fs::remove(path_ / "fused.ply");
  for (const fs::path& path : {path_, path_ / "sparse"}) {
    const Workspace workspace = ReadWorkspace(
        path, {.input_type = InputType::kSparse}, NetpbmDecoder());
    ASSERT_EQ(workspace.cloud.size(), sphere_.points.size() / 10);
    EXPECT_EQ(workspace.cloud.positions[1], sphere_.points[10]);
    EXPECT_EQ(workspace.cloud.views[1].size(), sphere_.point_images[10].size());
    EXPECT_FALSE(workspace.report.is_order_verified);
  }
}

TEST_F(WorkspaceTest, FindsTheOnlyDenseFolderBelow) {
  sphere_.Write(path_ / "dense" / "0");
  EXPECT_EQ(FindDenseFolder(path_), path_ / "dense" / "0");
  EXPECT_EQ(FindDenseFolder(path_ / "dense"), path_ / "dense" / "0");
  EXPECT_EQ(FindDenseFolder(path_ / "dense" / "0"), path_ / "dense" / "0");
  sphere_.Write(path_ / "dense" / "1");
  for (const char* text : {"dense/0", "dense/1"}) {
    ExpectFileError(text, [&] { FindDenseFolder(path_); });
  }
  ExpectFileError("no such folder", [&] { FindDenseFolder(path_ / "no"); });
  ExpectFileError("not a folder", [] { FindDenseFolder("/dev/null"); });
}

TEST_F(WorkspaceTest, FindsTheSparseModelOneFolderDeeper) {
  sphere_.Write(path_);
  fs::rename(path_ / "sparse", path_ / "0");
  ExpectRefused("no sparse model");
  fs::create_directory(path_ / "sparse");
  fs::rename(path_ / "0", path_ / "sparse" / "0");
  EXPECT_EQ(Read().report.sparse_path, path_ / "sparse" / "0");
}

TEST_F(WorkspaceTest, ScalesIntrinsicsToThePictures) {
  for (SphereWorkspace::Image& image : sphere_.images) {
    image.view.width = 40;  // of the picture; the camera stays 80 x 60
    image.view.height = 30;
  }
  const Workspace workspace = WriteAndRead();
  EXPECT_EQ(workspace.report.num_rescaled_images, 7);
  EXPECT_EQ(workspace.views[0].width, 40);
  EXPECT_EQ(workspace.views[0].fx, 45);
  EXPECT_EQ(workspace.views[0].fy, 45);
  EXPECT_EQ(workspace.views[0].cx, 20);
  EXPECT_EQ(workspace.views[0].cy, 15);
  sphere_.images[3].view.height = 40;
  sphere_.Write(path_);
  ExpectRefused("is 40 x 40 pixels, but its camera is 80 x 60");
}

TEST_F(WorkspaceTest, DoesWithoutPictures) {
  sphere_.write_images = false;
  EXPECT_EQ(WriteAndRead().report.num_missing_images, 7);
}

TEST_F(WorkspaceTest, TellsWhichPicturesCanNotBeUsed) {
  sphere_.vis_order = {5, 2, 0, 4, 3, 6, 1};
  sphere_.Write(path_);
  fs::remove(path_ / "images" / sphere_.images[0].view.name);
  WriteFile(path_ / "images" / sphere_.images[1].view.name, "no picture");
  WriteFile(path_ / "images" / sphere_.images[2].view.name,
            "P6\n9 2\n255\n" + std::string(54, 'x'));
  const Workspace workspace = Read({.allow_other_sizes = true});
  ASSERT_EQ(workspace.picture_errors.size(), 7);
  EXPECT_EQ(workspace.picture_errors[2], "no such file");
  EXPECT_EQ(workspace.picture_errors[6], "cannot be read");
  EXPECT_TRUE(Has(workspace.picture_errors[1], "is 9 x 2 pixels"));
  EXPECT_EQ(workspace.views[1].width, 80) << "its camera's";
  for (const size_t i : {0, 3, 4, 5}) {
    EXPECT_EQ(workspace.picture_errors[i], "");
  }
  ExpectRefused("is 9 x 2 pixels");
}

TEST_F(WorkspaceTest, ReadsTheSizeOfDepthMaps) {
  sphere_.Write(path_);
  const fs::path folder = path_ / "stereo" / "depth_maps";
  WriteFile(folder / "image9.ppm.geometric.bin", "40&30&1&....");
  WriteFile(folder / "image9.ppm.photometric.bin", "80&60&1&....");
  WriteFile(folder / "image2.ppm.photometric.bin", "20&15&1&....");
  EXPECT_EQ(Read().depth_map_scales,
            (std::vector<double>{1, 0.5, 0.25, 1, 1, 1, 1}));
  for (const char* header : {"", "&", "12", "-4&3&1&", "99999999999&1&1&"}) {
    WriteFile(folder / "image9.ppm.geometric.bin", header);
    SCOPED_TRACE(header);
    ExpectRefused("not a depth map");
  }
}

TEST_F(WorkspaceTest, RefusesDistortedCamerasOfDenseWorkspaces) {
  sphere_.Write(path_);
  fs::remove_all(path_ / "sparse");
  sphere_.WriteModel(path_ / "sparse", ".txt");
  WriteFile(path_ / "sparse" / "cameras.txt",
            "7 SIMPLE_RADIAL 80 60 90 40 30 0.1\n");
  ExpectRefused("image_undistorter");
  EXPECT_NO_THROW(Read({.input_type = InputType::kSparse}));
}

TEST_F(WorkspaceTest, DropsAndCountsPointsThatCanNotBeMeshed) {
  sphere_.points[3].x() = std::numeric_limits<float>::quiet_NaN();
  sphere_.points[4].z() = std::numeric_limits<float>::infinity();
  sphere_.points[7].y() = std::numeric_limits<float>::lowest();
  sphere_.point_images[5] = {};
  sphere_.point_images[6].push_back(sphere_.point_images[6][0]);
  const Workspace workspace = WriteAndRead();
  const FilterReport& report = workspace.report.points;
  EXPECT_EQ(report.num_points, sphere_.points.size());
  EXPECT_EQ(report.num_not_finite, 3);
  EXPECT_EQ(report.num_without_views, 1);
  EXPECT_EQ(report.num_with_repeats, 1);
  EXPECT_EQ(workspace.cloud.size(), sphere_.points.size() - 4);
  EXPECT_EQ(workspace.cloud.positions[3], sphere_.points[6]);
  EXPECT_EQ(workspace.cloud.views[3].size(),
            sphere_.point_images[6].size() - 1);
}

TEST_F(WorkspaceTest, DropsFewIndicesOutOfRangeAndRefusesMany) {
  sphere_.Write(path_);
  std::string vis = sphere_.Vis();
  const uint32_t bad = 1000;
  std::memcpy(vis.data() + 12, &bad, 4);  // the first of the first point
  WriteFile(path_ / "fused.ply.vis", vis);
  EXPECT_EQ(Read().report.points.num_out_of_range, 1);
  sphere_.images.pop_back();
  WriteFile(path_ / "sparse" / "images.bin", sphere_.ModelFile("images.bin"));
  ExpectRefused("beyond the 6 of sparse/");
}

TEST_F(WorkspaceTest, RefusesToGoWithoutFinitePointsOrAnyOrImages) {
  for (Eigen::Vector3f& point : sphere_.points) {
    point.x() = std::numeric_limits<float>::quiet_NaN();
  }
  sphere_.Write(path_);
  ExpectRefused((path_ / "fused.ply").string() + ": none of its " +
                std::to_string(sphere_.points.size()) + " points is finite");
  sphere_.points.clear();
  sphere_.point_images.clear();
  sphere_.Write(path_);
  ExpectRefused("no points");
  sphere_.images.clear();
  sphere_.vis_order.clear();
  sphere_.Write(path_);
  ExpectRefused("no images");
}

// Whatever is in the files, they are read or refused.
TEST_F(WorkspaceTest, SurvivesRandomDamage) {
  sphere_.frames = {{8, 4}, {9, 7, 1}, {2}, {5}};
  sphere_.points.resize(60);
  sphere_.point_images.resize(60);
  sphere_.Write(path_);
  std::mt19937 random(1);
  size_t num_refused = 0;
  for (const char* name :
       {"fused.ply", "fused.ply.vis", "sparse/cameras.bin", "sparse/images.bin",
        "sparse/points3D.bin", "sparse/frames.bin"}) {
    const std::string bytes = ReadFile(path_ / name);
    for (int i = 0; i < 100; ++i) {
      std::string damaged = bytes;
      for (int j = 0; j < 3; ++j) {
        damaged[random() % damaged.size()] = static_cast<char>(random());
      }
      WriteFile(path_ / name, damaged);
      try {
        const Workspace workspace = Read();
        for (const uint32_t index : workspace.cloud.views.values) {
          ASSERT_LT(index, workspace.views.size());
        }
      } catch (const FileError&) {
        ++num_refused;
      }
    }
    WriteFile(path_ / name, bytes);
  }
  EXPECT_GT(num_refused, 100);
}

TEST(FilterCloudTest, SortsRows) {
  FilterReport report;
  const PointCloud cloud =
      FilterCloud({std::vector<Eigen::Vector3f>(3, {1, 2, 3}), {}, {}},
                  {{0, 3, 5, 6}, {2, 0, 2, 9, 1, 9}}, 3, &report);
  EXPECT_EQ(cloud.views.offsets, (std::vector<uint64_t>{0, 2, 3}));
  EXPECT_EQ(cloud.views.values, (std::vector<uint32_t>{0, 2, 1}));
  EXPECT_EQ(report.num_out_of_range, 2);
  EXPECT_EQ(report.num_without_views, 1);
  EXPECT_TRUE(cloud.colors.empty());
}

struct ExpectOutputsTest : FolderTest {
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

TEST_F(ExpectOutputsTest, RefusesToReplaceInputsAndTwoOutputsOfOneName) {
  fs::create_symlink(path_ / "fused.ply", path_ / "link.ply");
  for (const char* name :
       {"fused.ply", "fused.ply.vis", "images/../fused.ply", "link.ply",
        "images/a/0.png", "stereo/fusion.cfg", "sparse/0/cameras.bin"}) {
    SCOPED_TRACE(name);
    ExpectRefused({{}, path_ / "new.ply", path_ / name},
                  "it is read, and would be replaced");
  }
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

}  // namespace colmap_ext::workspace_test
