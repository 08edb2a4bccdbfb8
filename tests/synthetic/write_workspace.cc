#include "tests/synthetic/write_workspace.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <numeric>
#include <stdexcept>
#include <vector>

#include <tbb/parallel_for.h>
#include <Eigen/Geometry>

#include "formats/write_mesh.h"
#include "tests/synthetic/colmap_workspace.h"
#include "tests/synthetic/noise.h"

namespace colmap_ext::synthetic {
namespace {

namespace fs = std::filesystem;

std::ofstream Open(const fs::path& path) {
  std::ofstream file(path, std::ios::trunc);
  if (!file) {
    throw std::runtime_error(path.string() + ": cannot be written");
  }
  file.precision(17);
  return file;
}

void Close(const fs::path& path, std::ofstream* file) {
  file->close();
  if (!*file) {
    throw std::runtime_error(path.string() + ": cannot be written");
  }
}

// 1 ... n in an order of the seed's.
std::vector<uint32_t> ImageIds(size_t num_images, uint64_t seed) {
  std::vector<uint32_t> ids(num_images);
  std::iota(ids.begin(), ids.end(), 1);
  std::sort(ids.begin(), ids.end(), [seed](uint32_t a, uint32_t b) {
    return Hash(seed, 40, a) < Hash(seed, 40, b);
  });
  return ids;
}

void WriteCamerasText(const fs::path& path, const View& view) {
  std::ofstream file = Open(path);
  file << "1 PINHOLE " << view.width << ' ' << view.height << ' ' << view.fx
       << ' ' << view.fy << ' ' << view.cx << ' ' << view.cy << '\n';
  Close(path, &file);
}

// \param feature_lines [views] the lines of the images' features
void WriteImagesText(const fs::path& path, const std::vector<View>& views,
                     const std::vector<uint32_t>& ids,
                     const std::vector<std::string>& feature_lines) {
  std::ofstream file = Open(path);
  for (size_t i = 0; i < views.size(); ++i) {
    const Eigen::Quaterniond q(views[i].cam_from_world_rotation);
    const Eigen::Vector3d& t = views[i].cam_from_world_translation;
    file << ids[i] << ' ' << q.w() << ' ' << q.x() << ' ' << q.y() << ' '
         << q.z() << ' ' << t.x() << ' ' << t.y() << ' ' << t.z() << " 1 "
         << views[i].name << '\n'
         << feature_lines[i] << '\n';
  }
  Close(path, &file);
}

// points3D.txt.
// \return the lines of the images' features for images.txt.
std::vector<std::string> WritePointsText(const fs::path& path,
                                         const std::vector<SparsePoint>& points,
                                         const std::vector<uint32_t>& ids) {
  std::ofstream file = Open(path);
  std::vector<std::string> lines(ids.size());
  std::vector<int> counts(ids.size(), 0);
  for (size_t i = 0; i < points.size(); ++i) {
    const SparsePoint& point = points[i];
    file << i + 1 << ' ' << point.position.x() << ' ' << point.position.y()
         << ' ' << point.position.z() << ' ' << int{point.color[0]} << ' '
         << int{point.color[1]} << ' ' << int{point.color[2]} << ' '
         << point.error;
    for (const Feature& feature : point.track) {
      file << ' ' << ids[feature.view] << ' ' << counts[feature.view]++;
      lines[feature.view] += std::to_string(feature.position.x()) + ' ' +
                             std::to_string(feature.position.y()) + ' ' +
                             std::to_string(i + 1) + ' ';
    }
    file << '\n';
  }
  Close(path, &file);
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
    WriteImage((path / scene.scene.views[i].name).string(), scene.images[i]);
  });
}

void WriteStereo(const fs::path& path, const DenseScene& scene) {
  fs::create_directories(path / "depth_maps");
  fs::create_directories(path / "normal_maps");
  fs::create_directories(path / "consistency_graphs");
  std::ofstream fusion = Open(path / "fusion.cfg");
  for (size_t i = 0; i < scene.depth_maps.size(); ++i) {
    const View& view = scene.scene.views[i];
    const DepthMap& map = scene.depth_maps[i];
    const std::string name = view.name + ".geometric.bin";
    fusion << view.name << '\n';
    WriteDepths((path / "depth_maps" / name).string(), map.width, map.height,
                map.depths);
    WriteNormals((path / "normal_maps" / name).string(), map, view);
  }
  Close(path / "fusion.cfg", &fusion);
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
    const Visible& visible = scene.visible[i];
    WriteDepths(
        (path / "depth_maps" / (views[i].name + ".geometric.bin")).string(),
        visible.width, visible.height, visible.depths);
  }
}

}  // namespace

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
