#include "tests/synthetic/write_workspace.h"

#include <algorithm>
#include <filesystem>
#include <sstream>

#include <tbb/parallel_for.h>
#include <Eigen/Geometry>

#if __has_include(<colmap/scene/reconstruction.h>)
#include <colmap/mvs/depth_map.h>
#include <colmap/mvs/fusion.h>
#include <colmap/mvs/normal_map.h>
#include <colmap/scene/reconstruction.h>
#include <colmap/util/ply.h>
#else
#include "base/pose.h"
#include "base/reconstruction.h"
#include "mvs/depth_map.h"
#include "mvs/fusion.h"
#include "mvs/normal_map.h"
#include "util/ply.h"
#endif

#include "formats/picture_files.h"
#include "formats/write_mesh.h"
#include "tests/raster/pixels.h"
#include "tests/synthetic/noise.h"

namespace colmap_ext::synthetic {
namespace {

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

// fused.ply and fused.ply.vis.
// \param positions [views] of the images in COLMAP's order
void WriteFusedPoints(const std::string& ply_path, const FusedPoints& points,
                      const std::vector<int>& positions) {
  const PointCloud& cloud = points.cloud;
  std::vector<colmap::PlyPoint> ply(cloud.size());
  std::vector<std::vector<int>> visibility(cloud.size());
  for (size_t i = 0; i < cloud.size(); ++i) {
    ply[i].x = cloud.positions[i].x();
    ply[i].y = cloud.positions[i].y();
    ply[i].z = cloud.positions[i].z();
    ply[i].nx = points.normals[i].x();
    ply[i].ny = points.normals[i].y();
    ply[i].nz = points.normals[i].z();
    if (!cloud.colors.empty()) {
      ply[i].r = cloud.colors[i][0];
      ply[i].g = cloud.colors[i][1];
      ply[i].b = cloud.colors[i][2];
    }
    for (const uint32_t view : cloud.views[i]) {
      visibility[i].push_back(positions[view]);
    }
  }
  colmap::WriteBinaryPlyPoints(ply_path, ply, true, true);
  colmap::mvs::WritePointsVisibility(ply_path + ".vis", visibility);
}

// COLMAP's file of a depth map.
void WriteDepths(const fs::path& path, const colmap_ext::DepthMap& depths) {
  float nearest = 0, farthest = 0;
  for (const float depth : depths.depths) {
    if (depth > 0) {
      nearest = nearest > 0 ? std::min(nearest, depth) : depth;
      farthest = std::max(farthest, depth);
    }
  }
  colmap::mvs::DepthMap map(depths.width, depths.height, nearest, farthest);
  ForEachPixel(depths, [&](int row, int col) {
    map.Set(row, col, depths.depths[depths.Index(row, col)]);
  });
  map.Write(path.string());
}

// COLMAP's file of a depth map's normals.
void WriteNormals(const fs::path& path, const DepthMap& map, const View& view) {
  colmap::mvs::NormalMap normals(map.width, map.height);
  ForEachPixel(map, [&](int row, int col) {
    const Eigen::Vector3f normal = view.cam_from_world_rotation.cast<float>() *
                                   map.normals[map.Index(row, col)];
    for (int i = 0; i < 3; ++i) {
      normals.Set(row, col, i, normal[i]);
    }
  });
  normals.Write(path.string());
}

// 1 ... n in an order of the seed's.
std::vector<uint32_t> ImageIds(size_t num_images, uint64_t seed) {
  std::vector<uint32_t> ids = Iota(num_images, 1);
  std::ranges::sort(ids, {},
                    [seed](uint32_t id) { return Hash(seed, 40, id); });
  return ids;
}

std::ostringstream Text() {
  std::ostringstream text;
  text.precision(17);
  return text;
}

void WriteCamerasText(const fs::path& path, const View& view) {
  std::ostringstream text = Text();
  text << "1 PINHOLE " << view.width << ' ' << view.height << ' ' << view.fx
       << ' ' << view.fy << ' ' << view.cx << ' ' << view.cy << '\n';
  WriteText(path, text.str());
}

// \param feature_lines [views] the lines of the images' features
void WriteImagesText(const fs::path& path, const std::vector<View>& views,
                     const std::vector<uint32_t>& ids,
                     const std::vector<std::string>& feature_lines) {
  std::ostringstream text = Text();
  for (size_t i = 0; i < views.size(); ++i) {
    const Eigen::Quaterniond q(views[i].cam_from_world_rotation);
    const Eigen::Vector3d& t = views[i].cam_from_world_translation;
    text << ids[i] << ' ' << q.w() << ' ' << q.x() << ' ' << q.y() << ' '
         << q.z() << ' ' << t.x() << ' ' << t.y() << ' ' << t.z() << " 1 "
         << views[i].name << '\n'
         << feature_lines[i] << '\n';
  }
  WriteText(path, text.str());
}

// points3D.txt.
// \return the lines of the images' features for images.txt.
std::vector<std::string> WritePointsText(const fs::path& path,
                                         const std::vector<SparsePoint>& points,
                                         const std::vector<uint32_t>& ids) {
  std::ostringstream text = Text();
  std::vector<std::string> lines(ids.size());
  std::vector<int> counts(ids.size(), 0);
  for (size_t i = 0; i < points.size(); ++i) {
    const SparsePoint& point = points[i];
    text << i + 1 << ' ' << point.position.x() << ' ' << point.position.y()
         << ' ' << point.position.z() << ' ' << int{point.color[0]} << ' '
         << int{point.color[1]} << ' ' << int{point.color[2]} << ' '
         << point.error;
    for (const Feature& feature : point.track) {
      text << ' ' << ids[feature.view] << ' ' << counts[feature.view]++;
      lines[feature.view] += std::to_string(feature.position.x()) + ' ' +
                             std::to_string(feature.position.y()) + ' ' +
                             std::to_string(i + 1) + ' ';
    }
    text << '\n';
  }
  WriteText(path, text.str());
  return lines;
}

// sparse/ in binary form, by way of the text form, which every version of
// COLMAP reads.
// \return the positions of the views in COLMAP's order.
std::vector<int> WriteSparseModel(const fs::path& path, const DenseScene& scene,
                                  const std::vector<uint32_t>& ids) {
  const fs::path text = path / "text";
  fs::create_directories(text);
  const std::vector<std::string> lines =
      WritePointsText(text / "points3D.txt", scene.sparse_points, ids);
  WriteImagesText(text / "images.txt", scene.model_views, ids, lines);
  WriteCamerasText(text / "cameras.txt", scene.model_views[0]);
  const auto by_name = ConvertModel(text.string(), path.string());
  fs::remove_all(text);
  std::vector<int> positions;
  for (const View& view : scene.scene.views) {
    positions.push_back(by_name.at(view.name));
  }
  return positions;
}

void WriteImages(const fs::path& path, const DenseScene& scene) {
  tbb::parallel_for(size_t{0}, scene.images.size(), [&](size_t i) {
    WritePng(path / scene.scene.views[i].name, scene.images[i]);
  });
}

void WriteStereo(const fs::path& path, const DenseScene& scene) {
  fs::create_directories(path / "depth_maps");
  fs::create_directories(path / "normal_maps");
  fs::create_directories(path / "consistency_graphs");
  std::string fusion;
  for (size_t i = 0; i < scene.depth_maps.size(); ++i) {
    const View& view = scene.scene.views[i];
    const std::string name = view.name + ".geometric.bin";
    fusion += view.name + '\n';
    WriteDepths(path / "depth_maps" / name, scene.depth_maps[i]);
    WriteNormals(path / "normal_maps" / name, scene.depth_maps[i], view);
  }
  WriteText(path / "fusion.cfg", fusion);
}

void WriteTruth(const fs::path& path, const DenseScene& scene,
                const std::vector<uint32_t>& ids) {
  const std::vector<View>& views = scene.scene.views;
  fs::create_directories(path / "depth_maps");
  WriteColoredMesh(path / "mesh.ply", scene.scene.surface, {});
  WriteCamerasText(path / "cameras.txt", views[0]);
  WriteImagesText(path / "images.txt", views, ids,
                  std::vector<std::string>(views.size()));
  for (size_t i = 0; i < scene.visible.size(); ++i) {
    WriteDepths(path / "depth_maps" / (views[i].name + ".geometric.bin"),
                scene.visible[i]);
  }
}

}  // namespace

std::map<std::string, int> ConvertModel(const std::string& path,
                                        const std::string& binary_path) {
  colmap::Reconstruction model;
  model.Read(path);
  model.WriteBinary(binary_path);
  colmap::Reconstruction written;
  written.ReadBinary(binary_path);
  std::map<std::string, int> positions;
  for (const auto image_id : written.RegImageIds()) {
    const int position = positions.size();
    positions[written.Image(image_id).Name()] = position;
  }
  return positions;
}

std::vector<View> ReadViews(const std::string& sparse_path) {
  colmap::Reconstruction model;
  model.Read(sparse_path);
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

void WriteWorkspace(const DenseScene& scene, uint64_t seed,
                    const std::string& path_name) {
  const fs::path path(path_name);
  const std::vector<View>& views = scene.scene.views;
  const std::vector<uint32_t> ids = ImageIds(views.size(), seed);
  fs::create_directories(path / "images");
  fs::create_directories(path / "sparse");
  WriteImages(path / "images", scene);
  const std::vector<int> positions =
      WriteSparseModel(path / "sparse", scene, ids);
  WriteFusedPoints((path / "fused.ply").string(), scene.fused, positions);
  if (!scene.depth_maps.empty()) {
    WriteStereo(path / "stereo", scene);
  }
  WriteTruth(path / "truth", scene, ids);
}

}  // namespace colmap_ext::synthetic
