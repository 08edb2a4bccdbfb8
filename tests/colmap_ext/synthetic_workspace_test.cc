// The synthetic workspaces, read back, by COLMAP too, and meshed as a user's
// are.

#include <algorithm>
#include <filesystem>
#include <map>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#if __has_include(<colmap/scene/reconstruction.h>)
#include <colmap/mvs/depth_map.h>
#include <colmap/mvs/normal_map.h>
#include <colmap/scene/reconstruction.h>
#include <colmap/util/ply.h>
#else
#include "base/pose.h"
#include "base/reconstruction.h"
#include "mvs/depth_map.h"
#include "mvs/normal_map.h"
#include "util/ply.h"
#endif

#include "colmap_ext/colmap_compat.h"
#include "formats/picture_files.h"
#include "formats/read_ply.h"
#include "meshing/ray_ends.h"
#include "tests/colmap_ext/run_shell.h"
#include "tests/raster/pixels.h"
#include "tests/synthetic/write_workspace.h"
#include "tests/workspace/sphere_workspace.h"
#include "workspace/image_order.h"
#include "workspace/sparse_model.h"
#include "workspace/workspace.h"

namespace colmap_ext::synthetic_workspace_test {

namespace fs = std::filesystem;

template <typename Image>
void SetPose(const Image& image, View* view) {
  if constexpr (requires { image.CamFromWorld(); }) {
    const Eigen::Matrix3x4d cam_from_world = image.CamFromWorld().ToMatrix();
    view->cam_from_world_rotation = cam_from_world.leftCols<3>();
    view->cam_from_world_translation = cam_from_world.col(3);
  } else {
    view->cam_from_world_rotation = image.RotationMatrix();
    view->cam_from_world_translation = image.Tvec();
  }
}

template <typename Camera>
void SetSize(const Camera& camera, View* view) {
  if constexpr (requires { camera.Width(); }) {
    view->width = camera.Width();
    view->height = camera.Height();
  } else {
    view->width = camera.width;
    view->height = camera.height;
  }
}

// The positions, colors and features of the points by their ids.
using Point = std::tuple<Eigen::Vector3d, Color,
                         std::vector<std::pair<uint32_t, Eigen::Vector2d>>>;
std::map<uint64_t, Point> PointsOf(const SparseModel& model) {
  const std::map<uint32_t, size_t> images = ImageIndices(model);
  std::map<uint64_t, Point> points;
  for (size_t i = 0; i < model.point_ids.size(); ++i) {
    auto& [position, color, track] = points[model.point_ids[i]];
    position = model.exact_positions[i];
    color = model.point_colors[i];
    for (size_t k = model.track_image_ids.offsets[i];
         k < model.track_image_ids.offsets[i + 1]; ++k) {
      const uint32_t image_id = model.track_image_ids.values[k];
      const SparseObservation& seen =
          model.images[images.at(image_id)]
              .observations[model.track_observations[k]];
      EXPECT_EQ(seen.point_id, model.point_ids[i]);
      track.emplace_back(image_id, seen.pixel);
    }
  }
  return points;
}

// The cameras of a sparse model, in COLMAP's order.
std::vector<View> ViewsOf(const colmap::Reconstruction& model) {
  std::vector<View> views;
  for (const auto image_id : model.RegImageIds()) {
    const auto& image = model.Image(image_id);
    const auto& camera = model.Camera(image.CameraId());
    const Eigen::Matrix3d calibration = camera.CalibrationMatrix();
    View view;
    view.name = image.Name();
    view.fx = calibration(0, 0);
    view.fy = calibration(1, 1);
    view.cx = calibration(0, 2);
    view.cy = calibration(1, 2);
    SetSize(camera, &view);
    SetPose(image, &view);
    views.push_back(view);
  }
  return views;
}

synthetic::DenseScene MakeSmallScene(const std::string& shape) {
  synthetic::DenseSceneOptions options;
  options.scene.shape = shape;
  options.scene.width = 120;
  options.scene.height = 90;
  options.keep_depth_maps = true;
  return MakeDenseScene(options);
}

struct SyntheticWorkspaceTest : testing::TestWithParam<const char*> {
  SyntheticWorkspaceTest() : scene_(MakeSmallScene(GetParam())) {
    WriteWorkspace(scene_, 1, path_.string());
  }

  TemporaryFolder folder_;
  fs::path path_ = folder_.Path() / "workspace";
  const synthetic::DenseScene scene_;
};

TEST_P(SyntheticWorkspaceTest, IsReadAsItWasMade) {
  const Workspace workspace = ReadWorkspace(path_, {}, ColmapPictureDecoder());
  EXPECT_TRUE(workspace.report.is_order_verified);
  EXPECT_EQ(workspace.report.num_missing_images, 0);
  EXPECT_EQ(workspace.report.num_rescaled_images, 0);
  EXPECT_EQ(workspace.sparse_points.size(), scene_.sparse_points.size());
  const std::vector<View>& views = scene_.scene.views;
  ASSERT_EQ(workspace.views.size(), views.size());
  std::map<std::string, size_t> index_of_name;
  for (size_t i = 0; i < views.size(); ++i) {
    index_of_name[views[i].name] = i;
  }
  for (const View& view : workspace.views) {
    const View& truth = views[index_of_name.at(view.name)];
    EXPECT_TRUE(view.Center().isApprox(truth.Center(), 1e-9));
    EXPECT_EQ(view.fx, truth.fx);
    EXPECT_EQ(view.width, truth.width);
  }
  const PointCloud& cloud = scene_.fused.cloud;
  EXPECT_EQ(workspace.cloud.positions, cloud.positions);
  EXPECT_EQ(workspace.cloud.colors, cloud.colors);
  ASSERT_EQ(workspace.cloud.views.offsets, cloud.views.offsets);
  for (size_t i = 0; i < cloud.size(); ++i) {
    std::vector<uint32_t> seen_by;
    for (const uint32_t view : workspace.cloud.views[i]) {
      seen_by.push_back(index_of_name.at(workspace.views[view].name));
    }
    std::ranges::sort(seen_by);
    EXPECT_TRUE(std::ranges::equal(seen_by, cloud.views[i]));
  }
}

// COLMAP reads the same, and writes what we read.
TEST_P(SyntheticWorkspaceTest, HasTheSparseModelForColmap) {
  colmap::Reconstruction model;
  model.Read((path_ / "sparse").string());
  std::vector<View> views = ViewsOf(model);
  std::ranges::sort(views, {}, &View::name);
  ASSERT_EQ(views.size(), scene_.model_views.size());
  for (size_t i = 0; i < views.size(); ++i) {
    const View& view = scene_.model_views[i];
    EXPECT_EQ(views[i].name, view.name);
    EXPECT_TRUE(views[i].cam_from_world_rotation.isApprox(
        view.cam_from_world_rotation, 1e-12));
    EXPECT_EQ(views[i].cam_from_world_translation,
              view.cam_from_world_translation);
    EXPECT_EQ(views[i].fx, view.fx);
    EXPECT_EQ(views[i].cy, view.cy);
    EXPECT_EQ(views[i].width, view.width);
  }
  const fs::path copy = folder_.Path() / "copy";
  fs::create_directory(copy);
  model.WriteBinary(copy.string());
  const std::map<uint64_t, Point> points =
      PointsOf(ReadSparseModel(copy, SparseDetail::kAll));
  EXPECT_TRUE(points ==
              PointsOf(ReadSparseModel(path_ / "sparse", SparseDetail::kAll)));
  ASSERT_EQ(points.size(), scene_.sparse_points.size());
  EXPECT_EQ(std::get<0>(points.at(1)), scene_.sparse_points[0].position);
}

TEST_P(SyntheticWorkspaceTest, HasTheFusedPointsForColmap) {
  const std::vector<colmap::PlyPoint> points =
      colmap::ReadPly((path_ / "fused.ply").string());
  const PointCloud& cloud = scene_.fused.cloud;
  ASSERT_EQ(points.size(), cloud.size());
  for (size_t i = 0; i < points.size(); ++i) {
    const colmap::PlyPoint& p = points[i];
    EXPECT_EQ(Eigen::Vector3f(p.x, p.y, p.z), cloud.positions[i]);
    EXPECT_EQ(Eigen::Vector3f(p.nx, p.ny, p.nz), scene_.fused.normals[i]);
    EXPECT_EQ((Color{p.r, p.g, p.b}), cloud.colors[i]);
  }
}

TEST_P(SyntheticWorkspaceTest, HasTheDepthAndNormalMapsForColmap) {
  for (size_t i = 0; i < scene_.depth_maps.size(); ++i) {
    const View& view = scene_.scene.views[i];
    const std::string name = view.name + ".geometric.bin";
    const synthetic::DepthMap& map = scene_.depth_maps[i];
    colmap::mvs::DepthMap depths(0, 0, 0, 0);
    depths.Read((path_ / "stereo" / "depth_maps" / name).string());
    EXPECT_EQ(depths.GetWidth(), map.width);
    EXPECT_EQ(depths.GetData(), map.depths);
    depths.Read((path_ / "truth" / "depth_maps" / name).string());
    EXPECT_EQ(depths.GetData(), scene_.visible[i].depths);
    colmap::mvs::NormalMap normals;
    normals.Read((path_ / "stereo" / "normal_maps" / name).string());
    ASSERT_EQ(normals.GetHeight(), map.height);
    ForEachPixel(map, [&](int row, int col) {
      Eigen::Vector3f normal;
      normals.GetSlice(row, col, normal.data());
      EXPECT_TRUE(normal.isApprox(view.cam_from_world_rotation.cast<float>() *
                                  map.normals[map.Index(row, col)]));
    });
  }
}

TEST_P(SyntheticWorkspaceTest, IsMeshed) {
  Succeed(RunProgram("delaunay_manifold_mesher" +
                     PathOption("workspace_path", path_)));
  const PlyCloud mesh = ReadPlyCloud(path_ / "meshed-delaunay-manifold.ply");
  EXPECT_GT(mesh.positions.size(), 300);
}

// Rays to masked pixels do not carve.
TEST_P(SyntheticWorkspaceTest, IsCarvedByItsDepthMaps) {
  const fs::path mesh = path_ / "meshed-delaunay-manifold.ply";
  const std::string arguments =
      "delaunay_manifold_mesher" + PathOption("workspace_path", path_);
  Succeed(RunProgram(arguments));
  const std::string whole = ReadFile(mesh);
  const auto num_rays = [&](const std::string& options) {
    const Outcome outcome =
        RunProgram(arguments + " @carve_with_depth_maps 1" + options);
    Succeed(outcome);
    const std::string name = "rays to depth maps";
    return std::stoul(outcome.out.substr(outcome.out.find(name) + name.size()));
  };
  size_t num_depths = 0;
  for (const synthetic::DepthMap& map : scene_.depth_maps) {
    for (int row = kDepthSpacing / 2; row < map.height; row += kDepthSpacing) {
      for (int col = kDepthSpacing / 2; col < map.width; col += kDepthSpacing) {
        num_depths += map.depths[map.Index(row, col)] > 0 ? 1 : 0;
      }
    }
  }
  EXPECT_EQ(num_rays(""), num_depths);
  EXPECT_NE(ReadFile(mesh), whole);
  ColorImage mask{120, 90, std::vector<Color>(120 * 90, {255, 255, 255})};
  std::fill_n(mask.pixels.begin(), 120 * 45, Color{0, 0, 0});
  fs::create_directory(folder_.Path() / "masks");
  for (const View& view : scene_.scene.views) {
    WritePng(folder_.Path() / "masks" / (view.name + ".png"), mask);
  }
  const size_t num_left =
      num_rays(PathOption("mask_path", folder_.Path() / "masks"));
  EXPECT_LT(num_left, num_depths);
  EXPECT_GT(num_left, 0u);
  fs::remove_all(path_ / "stereo" / "depth_maps");
  const Outcome outcome = RunProgram(arguments + " @carve_with_depth_maps 1");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_TRUE(outcome.err.find("no depth map of any image") !=
              std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(Scenes, SyntheticWorkspaceTest,
                         testing::Values("statue", "wall", "grid"));

struct SparseModelAgreementTest : testing::Test {
  SparseModelAgreementTest() {
    sphere_.points.resize(20);
    sphere_.point_images.assign(20, {0, 2});
    const fs::path old = folder_.Path() / "old";
    sphere_.WriteModel(old, ".bin");
    fs::create_directory(binary_);
    colmap::Reconstruction model;
    model.Read(old.string());
    model.WriteBinary(binary_.string());
    model_ = ReadSparseModel(binary_);
    colmap::Reconstruction written;
    written.ReadBinary(binary_.string());
    views_ = ViewsOf(written);
  }

  SphereWorkspace sphere_;
  TemporaryFolder folder_;
  // As this COLMAP writes it: with rigs and frames from 3.12 on.
  fs::path binary_ = folder_.Path() / "binary";
  SparseModel model_;
  std::vector<View> views_;
};

// What COLMAP itself writes and reads is what we read.
TEST_F(SparseModelAgreementTest, ReadsWhatThisColmapWrites) {
  ASSERT_EQ(model_.images.size(), views_.size());
  for (const View& view : views_) {
    const auto image = std::ranges::find_if(
        model_.images,
        [&](const SparseImage& other) { return other.name == view.name; });
    ASSERT_NE(image, model_.images.end()) << view.name;
    EXPECT_TRUE(image->cam_from_world_rotation.toRotationMatrix().isApprox(
        view.cam_from_world_rotation));
    EXPECT_TRUE(image->cam_from_world_translation.isApprox(
        view.cam_from_world_translation));
    const SparseCamera& camera = model_.cameras.at(image->camera_id);
    EXPECT_EQ(camera.fx, view.fx);
    EXPECT_EQ(camera.cy, view.cy);
    EXPECT_EQ(camera.width, view.width);
  }
  EXPECT_EQ(model_.point_positions.size(), 2);  // of 20, in the sphere's model
  const bool has_frames = fs::exists(binary_ / "frames.bin");
  EXPECT_EQ(model_.frames.size(), has_frames ? views_.size() : 0);
#if COLMAP_EXT_COLMAP_VERSION >= 31200
  EXPECT_TRUE(has_frames);
#endif
}

// The order that this COLMAP counts images by in a .vis is one of those that
// are tried, under the name that its version has in our reports.
TEST_F(SparseModelAgreementTest, KnowsTheImageOrderOfThisColmap) {
#if COLMAP_EXT_COLMAP_VERSION >= 31200
  constexpr ImageOrderKind kKind = ImageOrderKind::kFrame;
#elif COLMAP_EXT_COLMAP_VERSION >= 31100
  constexpr ImageOrderKind kKind = ImageOrderKind::kImageId;
#else
  constexpr ImageOrderKind kKind = ImageOrderKind::kFile;
#endif
  const std::vector<ImageOrder> orders = CandidateImageOrders(model_);
  const auto order = std::ranges::find_if(
      orders, [](const ImageOrder& other) { return other.kind == kKind; });
  ASSERT_NE(order, orders.end());
  ASSERT_EQ(order->images.size(), views_.size());
  for (size_t i = 0; i < views_.size(); ++i) {
    EXPECT_EQ(model_.images[order->images[i]].name, views_[i].name);
  }
}

TEST(ColmapPictureDecoder, ReadsPicturesInGrey) {
  const TemporaryFolder folder;
  const fs::path path = folder.Path();
  const PictureDecoder decoder = ColmapPictureDecoder();
  WriteFile(path / "gray.pgm", std::string("P5\n3 2\n255\n\x01\x02\x03"
                                           "\x04\x05\x06"));
  const std::optional<GrayImage> image = decoder.read_gray(path / "gray.pgm");
  ASSERT_TRUE(image);
  EXPECT_EQ(image->width, 3);
  EXPECT_EQ(image->height, 2);
  EXPECT_EQ(image->pixels, (std::vector<uint8_t>{1, 2, 3, 4, 5, 6}));
  // 10 20 30, 1 2 6 and 255 255 255.
  WriteFile(path / "color.ppm",
            "P6\n3 1\n255\n\x0a\x14\x1e\x01\x02\x06\xff\xff\xff");
  const std::optional<GrayImage> color = decoder.read_gray(path / "color.ppm");
  ASSERT_TRUE(color);
  EXPECT_EQ(color->pixels, (std::vector<uint8_t>{20, 3, 255}));
  EXPECT_FALSE(decoder.read_gray(path / "none.png"));
}

TEST(ColmapPictureDecoder, ReadsOurPng) {
  const TemporaryFolder folder;
  ColorImage image{13, 7, {}};
  for (int i = 0; i < 13 * 7; ++i) {
    image.pixels.push_back({static_cast<uint8_t>(5 * i),
                            static_cast<uint8_t>(i % 13),
                            static_cast<uint8_t>(i * i)});
  }
  WritePng(folder.Path() / "a.png", image);
  const std::optional<ColorImage> read =
      ColmapPictureDecoder().read_color(folder.Path() / "a.png");
  ASSERT_TRUE(read);
  EXPECT_EQ(read->width, 13);
  EXPECT_EQ(read->pixels, image.pixels);
}

}  // namespace colmap_ext::synthetic_workspace_test
