#include "tests/synthetic/colmap_workspace.h"

#include <algorithm>
#include <stdexcept>

#if __has_include(<colmap/scene/reconstruction.h>)
#include <colmap/mvs/depth_map.h>
#include <colmap/mvs/fusion.h>
#include <colmap/mvs/normal_map.h>
#include <colmap/scene/reconstruction.h>
#include <colmap/sensor/bitmap.h>
#include <colmap/util/ply.h>
#else
#include "base/pose.h"
#include "base/reconstruction.h"
#include "mvs/depth_map.h"
#include "mvs/fusion.h"
#include "mvs/normal_map.h"
#include "util/bitmap.h"
#include "util/ply.h"
#endif

#include "colmap_ext/colmap_compat.h"

namespace colmap_ext::synthetic {
namespace {

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

}  // namespace

void WriteImage(const std::string& path, const ColorImage& image) {
  if (!WriteColorImage(path, image)) {
    throw std::runtime_error(path + ": cannot be written");
  }
}

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

void WriteDepths(const std::string& path, int width, int height,
                 const std::vector<float>& depths) {
  float nearest = 0, farthest = 0;
  for (const float depth : depths) {
    if (depth > 0) {
      nearest = nearest > 0 ? std::min(nearest, depth) : depth;
      farthest = std::max(farthest, depth);
    }
  }
  colmap::mvs::DepthMap map(width, height, nearest, farthest);
  for (int row = 0; row < height; ++row) {
    for (int col = 0; col < width; ++col) {
      map.Set(row, col, depths[static_cast<size_t>(row) * width + col]);
    }
  }
  map.Write(path);
}

void WriteNormals(const std::string& path, const DepthMap& map,
                  const View& view) {
  colmap::mvs::NormalMap normals(map.width, map.height);
  for (int row = 0; row < map.height; ++row) {
    for (int col = 0; col < map.width; ++col) {
      const Eigen::Vector3f normal =
          view.cam_from_world_rotation.cast<float>() *
          map.normals[map.Index(row, col)];
      for (int i = 0; i < 3; ++i) {
        normals.Set(row, col, i, normal[i]);
      }
    }
  }
  normals.Write(path);
}

}  // namespace colmap_ext::synthetic
