#include "workspace/sparse_model.h"

#include <cmath>
#include <limits>
#include <set>

#include <fmt/format.h>

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
  for (const char* name : {"cameras", "images", "points3D"}) {
    if (!std::filesystem::exists(folder / (std::string(name) + extension))) {
      return false;
    }
  }
  return true;
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
}

}  // namespace

const CameraModelInfo* FindCameraModel(int model_id) {
  const bool exists = model_id >= 0 && model_id < int{std::size(kCameraModels)};
  return exists ? &kCameraModels[model_id] : nullptr;
}

const CameraModelInfo* FindCameraModel(const std::string& name) {
  for (const CameraModelInfo& info : kCameraModels) {
    if (name == info.name) {
      return &info;
    }
  }
  return nullptr;
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
  for (const char* name : {"cameras", "images", "points3D", "frames"}) {
    files.push_back(folder / (std::string(name) + extension));
  }
  std::error_code error;
  if (!std::filesystem::exists(files.back(), error)) {
    files.pop_back();
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

}  // namespace colmap_ext
