#include "tests/synthetic/write_workspace.h"

#include <algorithm>
#include <filesystem>
#include <sstream>
#include <unordered_map>

#include <tbb/parallel_for.h>
#include <Eigen/Geometry>

#include "formats/atomic_file.h"
#include "formats/picture_files.h"
#include "formats/write_mesh.h"
#include "tests/synthetic/noise.h"
#include "workspace/sparse_model.h"

namespace colmap_ext::synthetic {
namespace {

namespace fs = std::filesystem;

// fused.ply and fused.ply.vis.
// \param positions [views] of the images in the sparse model
void WriteFusedPoints(const fs::path& path, const FusedPoints& points,
                      const std::vector<uint32_t>& positions) {
  const PointCloud& cloud = points.cloud;
  const std::string header =
      "ply\nformat binary_little_endian 1.0\nelement vertex " +
      std::to_string(cloud.size()) +
      "\nproperty float x\nproperty float y\nproperty float z\n"
      "property float nx\nproperty float ny\nproperty float nz\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\n"
      "end_header\n";
  AtomicFiles files;
  AtomicFile* ply = files.Add(path);
  AtomicFile* vis = files.Add(VisibilityPath(path));
  ply->Write(header.data(), header.size());
  vis->Write(uint64_t{cloud.size()});
  for (size_t i = 0; i < cloud.size(); ++i) {
    ply->Write(cloud.positions[i]);
    ply->Write(points.normals[i]);
    ply->Write(cloud.colors.empty() ? Color{} : cloud.colors[i]);
    vis->Write(static_cast<uint32_t>(cloud.views[i].size()));
    for (const uint32_t view : cloud.views[i]) {
      vis->Write(positions[view]);
    }
  }
  files.Commit();
}

// COLMAP's file of a depth or normal map.
// \param values [channels * height * width]
void WriteMap(const fs::path& path, const colmap_ext::DepthMap& map,
              const std::vector<float>& values) {
  const size_t num_pixels = map.depths.size();
  const std::string size = std::to_string(map.width) + '&' +
                           std::to_string(map.height) + '&' +
                           std::to_string(values.size() / num_pixels) + '&';
  AtomicFiles files;
  AtomicFile* file = files.Add(path);
  file->Write(size.data(), size.size());
  file->Write(values.data(), values.size() * sizeof(float));
  files.Commit();
}

void WriteNormals(const fs::path& path, const DepthMap& map, const View& view) {
  const Eigen::Matrix3f rotation = view.cam_from_world_rotation.cast<float>();
  const size_t num_pixels = map.normals.size();
  std::vector<float> values(3 * num_pixels);
  for (size_t i = 0; i < num_pixels; ++i) {
    const Eigen::Vector3f normal = rotation * map.normals[i];
    for (size_t channel = 0; channel < 3; ++channel) {
      values[channel * num_pixels + i] = normal[channel];
    }
  }
  WriteMap(path, map, values);
}

// 1 ... n in an order of the seed's.
std::vector<uint32_t> ImageIds(size_t num_images, uint64_t seed) {
  std::vector<uint32_t> ids = Iota(num_images, 1);
  std::ranges::sort(ids, {},
                    [seed](uint32_t id) { return Hash(seed, 40, id); });
  return ids;
}

SparseModel MakeSparseModel(const DenseScene& scene,
                            const std::vector<uint32_t>& ids) {
  SparseModel model;
  std::vector<std::vector<SparseObservation>> observations(ids.size());
  for (size_t i = 0; i < scene.sparse_points.size(); ++i) {
    const SparsePoint& point = scene.sparse_points[i];
    model.point_ids.push_back(i + 1);
    model.exact_positions.push_back(point.position);
    model.point_colors.push_back(point.color);
    for (const auto& [view, position] : point.track) {
      model.track_image_ids.values.push_back(ids[view]);
      model.track_observations.push_back(observations[view].size());
      // To the digits of COLMAP's text files.
      observations[view].push_back(
          {(1e6 * position).array().round() / 1e6, i + 1});
    }
    model.track_image_ids.EndRow();
  }
  const View& first = scene.model_views[0];
  model.cameras[1] =
      MakeSparseCamera(*FindCameraModel("PINHOLE"), first.width, first.height,
                       {first.fx, first.fy, first.cx, first.cy});
  // COLMAP 3.8 writes images in the order of such a table.
  std::unordered_map<uint32_t, size_t> view_of_id;
  for (size_t i = 0; i < ids.size(); ++i) {
    view_of_id[ids[i]] = i;
  }
  for (const auto& [image_id, i] : view_of_id) {
    const View& view = scene.model_views[i];
    model.images.push_back(
        {image_id, 1, view.name,
         Eigen::Quaterniond(view.cam_from_world_rotation).normalized(),
         view.cam_from_world_translation, std::move(observations[i])});
  }
  return model;
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
    WriteMap(path / "depth_maps" / name, scene.depth_maps[i],
             scene.depth_maps[i].depths);
    WriteNormals(path / "normal_maps" / name, scene.depth_maps[i], view);
  }
  WriteText(path / "fusion.cfg", fusion);
}

void WriteTruth(const fs::path& path, const DenseScene& scene,
                const std::vector<uint32_t>& ids) {
  const std::vector<View>& views = scene.scene.views;
  fs::create_directories(path / "depth_maps");
  WriteColoredMesh(path / "mesh.ply", scene.scene.surface, {});
  std::ostringstream cameras;
  cameras.precision(17);
  cameras << "1 PINHOLE " << views[0].width << ' ' << views[0].height << ' '
          << views[0].fx << ' ' << views[0].fy << ' ' << views[0].cx << ' '
          << views[0].cy << '\n';
  WriteText(path / "cameras.txt", cameras.str());
  std::ostringstream images;
  images.precision(17);
  for (size_t i = 0; i < views.size(); ++i) {
    const Eigen::Quaterniond q(views[i].cam_from_world_rotation);
    const Eigen::Vector3d& t = views[i].cam_from_world_translation;
    images << ids[i] << ' ' << q.w() << ' ' << q.x() << ' ' << q.y() << ' '
           << q.z() << ' ' << t.x() << ' ' << t.y() << ' ' << t.z() << " 1 "
           << views[i].name << "\n\n";
  }
  WriteText(path / "images.txt", images.str());
  for (size_t i = 0; i < scene.visible.size(); ++i) {
    WriteMap(path / "depth_maps" / (views[i].name + ".geometric.bin"),
             scene.visible[i], scene.visible[i].depths);
  }
}

}  // namespace

void WriteWorkspace(const DenseScene& scene, uint64_t seed,
                    const std::string& path_name) {
  const fs::path path(path_name);
  const std::vector<uint32_t> ids = ImageIds(scene.scene.views.size(), seed);
  fs::create_directories(path / "images");
  WriteImages(path / "images", scene);
  const SparseModel model = MakeSparseModel(scene, ids);
  WriteSparseModel(path / "sparse", model);
  const std::map<uint32_t, size_t> position_of_id = ImageIndices(model);
  std::vector<uint32_t> positions;
  for (const uint32_t id : ids) {
    positions.push_back(position_of_id.at(id));
  }
  WriteFusedPoints(path / "fused.ply", scene.fused, positions);
  if (!scene.depth_maps.empty()) {
    WriteStereo(path / "stereo", scene);
  }
  WriteTruth(path / "truth", scene, ids);
}

}  // namespace colmap_ext::synthetic
