#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "base/rows.h"
#include "scene/point_cloud.h"

namespace colmap_ext {

// A COLMAP sparse model as its files have it. We read the files ourselves:
// COLMAP's own readers abort on damaged files, older ones know nothing of the
// frames of newer models, and newer ones lose the order of images.bin, which
// is what fused.ply.vis of older ones refers to.

struct SparseCamera {
  std::string model_name;        // "PINHOLE"
  uint64_t width = 0;            // px
  uint64_t height = 0;           // px
  double fx = 1;                 // px
  double fy = 1;                 // px
  double cx = 0;                 // px, centre of the first pixel at 0.5
  double cy = 0;                 // px
  bool is_pinhole = true;        // no distortion
  bool has_focal_length = true;  // else a panorama; fx ... cy say nothing
};

inline constexpr uint64_t kNoSparsePoint = UINT64_MAX;

// A feature of an image.
struct SparseObservation {
  Eigen::Vector2d pixel;  // px of the camera, centre of the first pixel at 0.5
  uint64_t point_id = kNoSparsePoint;  // of the 3D point that it shows

  bool operator==(const SparseObservation&) const = default;
};

struct SparseImage {
  uint32_t image_id = 0;
  uint32_t camera_id = 0;
  std::string name;  // relative to the folder of the images
  Eigen::Quaterniond cam_from_world_rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d cam_from_world_translation = Eigen::Vector3d::Zero();
  std::vector<SparseObservation> observations;  // with SparseDetail::kAll
};

// A sensor of a rig, in the frame of the first one, its reference.
struct SparseSensor {
  int sensor_type = 0;  // 0: camera
  uint32_t sensor_id = 0;
  uint8_t has_pose = 0;  // not the reference
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
};

// Sensors that are fixed to each other (COLMAP 3.12 and later).
struct SparseRig {
  uint32_t rig_id = 0;
  std::vector<SparseSensor> sensors;
};

// A picture, or other data, that a sensor took.
struct SparseData {
  int sensor_type = 0;  // 0: camera
  uint32_t sensor_id = 0;
  uint64_t data_id = 0;  // of a camera: image_id
};

// The images that a rig took at one time (COLMAP 3.12 and later).
struct SparseFrame {
  uint32_t frame_id = 0;
  std::vector<uint32_t> image_ids;  // in the order of the rig's sensors
  uint32_t rig_id = 0;
  Eigen::Quaterniond rig_from_world_rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d rig_from_world_translation = Eigen::Vector3d::Zero();
  std::vector<SparseData> data;  // as in the file
};

struct SparseModel {
  std::map<uint32_t, SparseCamera> cameras;      // by camera_id
  std::vector<SparseImage> images;               // in the order of the file
  std::vector<SparseFrame> frames;               // likewise; empty before 3.12
  std::vector<Eigen::Vector3f> point_positions;  // [P], world, scene units
  std::vector<Color> point_colors;               // [P]
  Rows<uint32_t> track_image_ids;                // [P] of the observations

  // With SparseDetail::kAll.
  std::vector<SparseRig> rigs;                   // empty before 3.12
  std::vector<uint64_t> point_ids;               // [P]
  std::vector<Eigen::Vector3d> exact_positions;  // [P] point_positions as read
  std::vector<uint32_t> track_observations;  // for each of track_image_ids, the
                                             // index of the observation in its
                                             // image; may be out of range
};

enum class SparseDetail {
  kCameras,  // cameras, images, and points with their images
  kAll,      // all that is needed to write the model again
};

// The indices of the images by image_id.
std::map<uint32_t, size_t> ImageIndices(const SparseModel& model);

// Whether the folder has the files of a model, binary or text.
bool HasSparseModel(const std::filesystem::path& folder);

// The files that ReadSparseModel() reads, in the same order for every folder.
std::vector<std::filesystem::path> SparseModelFiles(
    const std::filesystem::path& folder);

// Reads a model of any COLMAP version up to 4.x, binary if it is there, else
// text.
// \throw FileError if a file is missing, truncated or damaged, or an image
//        refers to a camera that is not there.
SparseModel ReadSparseModel(const std::filesystem::path& folder,
                            SparseDetail detail = SparseDetail::kCameras);

// The same of one of the formats, unchecked.
SparseModel ReadSparseModelFiles(const std::filesystem::path& folder,
                                 bool is_binary, SparseDetail detail);

// Writes a model in COLMAP's binary format: cameras, images with their
// observations, points with their tracks and errors, and, where there are any,
// rigs and frames. The folder is made if it is not there; all files get their
// names together, after they have reached the disk. What belongs to a model of
// another COLMAP version is removed.
// \pre the model was read in full, and has pinhole cameras alone
// \throw FileError if it cannot be written: no file is changed then.
void WriteSparseModel(const std::filesystem::path& folder,
                      const SparseModel& model);

// What COLMAP's camera models have in common: the numbers of parameters, and
// how many of the first are focal lengths.
struct CameraModelInfo {
  const char* name;
  int num_params;
  int num_focal_lengths;  // 0 for panoramas
  bool is_pinhole;
};

// \return nullptr if COLMAP 4.1 has no such model.
const CameraModelInfo* FindCameraModel(int model_id);
const CameraModelInfo* FindCameraModel(const std::string& name);

// What to do about cameras whose model is unknown, for messages.
inline constexpr const char* kUndistort =
    "`colmap image_undistorter` of the COLMAP that wrote it makes it PINHOLE";

// \pre params.size() == info.num_params
SparseCamera MakeSparseCamera(const CameraModelInfo& info, uint64_t width,
                              uint64_t height,
                              const std::vector<double>& params);

}  // namespace colmap_ext
