#include "workspace/sparse_model.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <system_error>

#include <fmt/format.h>

#include "formats/atomic_file.h"
#include "formats/errors.h"

namespace colmap_ext {
namespace {

// Indexed by COLMAP's model ids.
constexpr CameraModelInfo kCameraModels[] = {
    {"SIMPLE_PINHOLE", 3, 1, true},
    {"PINHOLE", 4, 2, true},
    {"SIMPLE_RADIAL", 4, 1, false},
    {"RADIAL", 5, 1, false},
    {"OPENCV", 8, 2, false},
    {"OPENCV_FISHEYE", 8, 2, false},
    {"FULL_OPENCV", 12, 2, false},
    {"FOV", 5, 2, false},
    {"SIMPLE_RADIAL_FISHEYE", 4, 1, false},
    {"RADIAL_FISHEYE", 5, 1, false},
    {"THIN_PRISM_FISHEYE", 12, 2, false},
    {"RAD_TAN_THIN_PRISM_FISHEYE", 16, 2, false},  // 3.9
    {"SIMPLE_DIVISION", 4, 1, false},              // 4.0
    {"DIVISION", 5, 2, false},
    {"SIMPLE_FISHEYE", 3, 1, false},
    {"FISHEYE", 4, 2, false},
    {"EUCM", 6, 2, false},             // 4.1
    {"EQUIRECTANGULAR", 2, 0, false},  // its size
};

bool HasFiles(const std::filesystem::path& folder, const char* extension) {
  const std::string names[] = {"cameras", "images", "points3D"};
  return std::ranges::all_of(names, [&](const std::string& name) {
    return std::filesystem::exists(folder / (name + extension));
  });
}

void CheckCameras(const SparseModel& model,
                  const std::filesystem::path& folder) {
  constexpr uint64_t kMaxSize = std::numeric_limits<int>::max();
  for (const auto& [camera_id, camera] : model.cameras) {
    const bool is_sound = camera.width > 0 && camera.width <= kMaxSize &&
                          camera.height > 0 && camera.height <= kMaxSize &&
                          std::isfinite(camera.fx) && camera.fx > 0 &&
                          std::isfinite(camera.fy) && camera.fy > 0 &&
                          std::isfinite(camera.cx) && std::isfinite(camera.cy);
    if (!is_sound) {
      throw FileError(
          folder,
          fmt::format("camera {} has an impossible size or focal length",
                      camera_id));
    }
  }
}

void CheckImages(const SparseModel& model,
                 const std::filesystem::path& folder) {
  std::set<uint32_t> image_ids;
  for (const SparseImage& image : model.images) {
    const std::string label = fmt::format("image {}", image.image_id);
    if (!image_ids.insert(image.image_id).second) {
      throw FileError(folder, label + " is there twice");
    }
    if (!model.cameras.contains(image.camera_id)) {
      throw FileError(folder,
                      fmt::format("{} refers to camera {}, which is not there",
                                  label, image.camera_id));
    }
    if (!image.cam_from_world_rotation.coeffs().allFinite() ||
        !image.cam_from_world_translation.allFinite()) {
      throw FileError(folder, label + " has no valid pose");
    }
  }
  std::set<uint32_t> framed_ids;
  for (const SparseFrame& frame : model.frames) {
    for (const uint32_t image_id : frame.image_ids) {
      if (!framed_ids.insert(image_id).second) {
        throw FileError(
            folder, fmt::format("image {} is in its frames twice", image_id));
      }
    }
  }
}

// COLMAP's binary model format: https://colmap.github.io/format.html, and
// src/colmap/scene/reconstruction_io_binary.cc for frames.bin and rigs.bin.

template <typename... Values>
void Write(AtomicFile* file, const Values&... values) {
  (file->Write(values), ...);
}

void WriteCameras(const SparseModel& model, AtomicFile* file) {
  constexpr int kPinhole = 1;  // COLMAP's model id
  constexpr int kSimplePinhole = 0;
  file->Write(uint64_t{model.cameras.size()});
  for (const auto& [camera_id, camera] : model.cameras) {
    const bool is_simple = camera.model_name == "SIMPLE_PINHOLE";
    Write(file, camera_id, is_simple ? kSimplePinhole : kPinhole, camera.width,
          camera.height, camera.fx);
    if (!is_simple) {
      file->Write(camera.fy);
    }
    Write(file, camera.cx, camera.cy);
  }
}

void WritePose(const Eigen::Quaterniond& q, const Eigen::Vector3d& t,
               AtomicFile* file) {
  Write(file, q.w(), q.x(), q.y(), q.z(), t.x(), t.y(), t.z());
}

void WriteImages(const SparseModel& model, AtomicFile* file) {
  file->Write(uint64_t{model.images.size()});
  for (const SparseImage& image : model.images) {
    file->Write(image.image_id);
    WritePose(image.cam_from_world_rotation, image.cam_from_world_translation,
              file);
    file->Write(image.camera_id);
    file->Write(image.name.c_str(), image.name.size() + 1);
    file->Write(uint64_t{image.observations.size()});
    for (const auto& [pixel, point_id] : image.observations) {
      Write(file, pixel.x(), pixel.y(), point_id);
    }
  }
}

// The mean distance of a point's observations from its projections, px of the
// cameras.
// \param images  see ImageIndices()
double MeanError(const SparseModel& model,
                 const std::map<uint32_t, size_t>& images, size_t point) {
  const Rows<uint32_t>& tracks = model.track_image_ids;
  double sum = 0;
  size_t count = 0;
  for (uint64_t k = tracks.offsets[point]; k < tracks.offsets[point + 1]; ++k) {
    const auto it = images.find(tracks.values[k]);
    if (it == images.end()) {
      continue;
    }
    const SparseImage& image = model.images[it->second];
    if (model.track_observations[k] >= image.observations.size()) {
      continue;
    }
    const SparseCamera& camera = model.cameras.at(image.camera_id);
    const Eigen::Vector3d p =
        image.cam_from_world_rotation * model.exact_positions[point] +
        image.cam_from_world_translation;
    const Eigen::Vector2d pixel(camera.fx * p.x() / p.z() + camera.cx,
                                camera.fy * p.y() / p.z() + camera.cy);
    sum +=
        (pixel - image.observations[model.track_observations[k]].pixel).norm();
    ++count;
  }
  return count > 0 ? sum / static_cast<double>(count) : 0;
}

void WritePoints(const SparseModel& model, AtomicFile* file) {
  const std::map<uint32_t, size_t> images = ImageIndices(model);
  file->Write(uint64_t{model.point_ids.size()});
  for (size_t i = 0; i < model.point_ids.size(); ++i) {
    const Rows<uint32_t>& tracks = model.track_image_ids;
    const Eigen::Vector3d& position = model.exact_positions[i];
    Write(file, model.point_ids[i], position.x(), position.y(), position.z(),
          model.point_colors[i], MeanError(model, images, i),
          uint64_t{tracks[i].size()});
    for (uint64_t k = tracks.offsets[i]; k < tracks.offsets[i + 1]; ++k) {
      Write(file, tracks.values[k], model.track_observations[k]);
    }
  }
}

void WriteRigs(const SparseModel& model, AtomicFile* file) {
  file->Write(uint64_t{model.rigs.size()});
  for (const SparseRig& rig : model.rigs) {
    Write(file, rig.rig_id, static_cast<uint32_t>(rig.sensors.size()));
    for (const SparseSensor& sensor : rig.sensors) {
      Write(file, sensor.sensor_type, sensor.sensor_id);
      if (&sensor != rig.sensors.data()) {
        file->Write(sensor.has_pose);
      }
      if (sensor.has_pose != 0) {
        WritePose(sensor.rotation, sensor.translation, file);
      }
    }
  }
}

void WriteFrames(const SparseModel& model, AtomicFile* file) {
  file->Write(uint64_t{model.frames.size()});
  for (const SparseFrame& frame : model.frames) {
    Write(file, frame.frame_id, frame.rig_id);
    WritePose(frame.rig_from_world_rotation, frame.rig_from_world_translation,
              file);
    file->Write(static_cast<uint32_t>(frame.data.size()));
    for (const SparseData& data : frame.data) {
      Write(file, data.sensor_type, data.sensor_id, data.data_id);
    }
  }
}

void WriteFiles(const std::filesystem::path& folder, const SparseModel& model) {
  AtomicFiles files;
  WriteCameras(model, files.Add(folder / "cameras.bin"));
  WriteImages(model, files.Add(folder / "images.bin"));
  WritePoints(model, files.Add(folder / "points3D.bin"));
  if (!model.frames.empty()) {
    WriteRigs(model, files.Add(folder / "rigs.bin"));
    WriteFrames(model, files.Add(folder / "frames.bin"));
  }
  files.Commit();
}

}  // namespace

const CameraModelInfo* FindCameraModel(int model_id) {
  const bool exists = model_id >= 0 && model_id < int{std::size(kCameraModels)};
  return exists ? &kCameraModels[model_id] : nullptr;
}

const CameraModelInfo* FindCameraModel(const std::string& name) {
  const auto* found =
      std::ranges::find(kCameraModels, name, &CameraModelInfo::name);
  return found != std::end(kCameraModels) ? found : nullptr;
}

SparseCamera MakeSparseCamera(const CameraModelInfo& info, uint64_t width,
                              uint64_t height,
                              const std::vector<double>& params) {
  SparseCamera camera;
  camera.model_name = info.name;
  camera.width = width;
  camera.height = height;
  camera.is_pinhole = info.is_pinhole;
  camera.has_focal_length = info.num_focal_lengths > 0;
  if (!camera.has_focal_length) {
    return camera;
  }
  camera.fx = params[0];
  camera.fy = params[info.num_focal_lengths - 1];
  camera.cx = params[info.num_focal_lengths];
  camera.cy = params[info.num_focal_lengths + 1];
  return camera;
}

std::map<uint32_t, size_t> ImageIndices(const SparseModel& model) {
  std::map<uint32_t, size_t> index_of_id;
  for (size_t i = 0; i < model.images.size(); ++i) {
    index_of_id[model.images[i].image_id] = i;
  }
  return index_of_id;
}

bool HasSparseModel(const std::filesystem::path& folder) {
  return HasFiles(folder, ".bin") || HasFiles(folder, ".txt");
}

std::vector<std::filesystem::path> SparseModelFiles(
    const std::filesystem::path& folder) {
  const char* extension = HasFiles(folder, ".bin") ? ".bin" : ".txt";
  std::vector<std::filesystem::path> files;
  for (const char* name : {"cameras", "images", "points3D", "rigs", "frames"}) {
    files.push_back(folder / (std::string(name) + extension));
  }
  std::error_code error;
  if (!std::filesystem::exists(files.back(), error)) {
    files.resize(3);  // before COLMAP 3.12
  }
  return files;
}

SparseModel ReadSparseModel(const std::filesystem::path& folder,
                            SparseDetail detail) {
  SparseModel model =
      ReadSparseModelFiles(folder, HasFiles(folder, ".bin"), detail);
  CheckCameras(model, folder);
  CheckImages(model, folder);
  return model;
}

void WriteSparseModel(const std::filesystem::path& folder,
                      const SparseModel& model) {
  std::error_code error;
  std::error_code ignored;
  const bool is_new = !std::filesystem::exists(folder, ignored);
  std::filesystem::create_directories(folder, error);
  if (error || !std::filesystem::is_directory(folder, ignored)) {
    throw FileError(folder, "the folder cannot be made");
  }
  try {
    WriteFiles(folder, model);
  } catch (...) {
    if (is_new) {
      std::filesystem::remove(folder, ignored);
    }
    throw;
  }
  if (model.frames.empty()) {
    std::filesystem::remove(folder / "rigs.bin", ignored);
    std::filesystem::remove(folder / "frames.bin", ignored);
  }
}

}  // namespace colmap_ext
