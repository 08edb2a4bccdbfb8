// COLMAP's binary model format: https://colmap.github.io/format.html, and
// src/colmap/scene/reconstruction_io_binary.cc for frames.bin.

#include <algorithm>
#include <tuple>

#include <fmt/format.h>

#include "formats/byte_reader.h"
#include "formats/errors.h"
#include "workspace/sparse_model.h"

namespace colmap_ext {

namespace {

constexpr uint64_t kMinCameraBytes = 4 + 4 + 8 + 8 + 2 * 8;
constexpr uint64_t kMinImageBytes = 4 + 7 * 8 + 4 + 1 + 8;
constexpr uint64_t kPoint2DBytes = 8 + 8 + 8;
constexpr uint64_t kMinPoint3DBytes = 8 + 3 * 8 + 3 + 8 + 8;
constexpr uint64_t kTrackElementBytes = 4 + 4;
constexpr uint64_t kMinFrameBytes = 4 + 4 + 7 * 8 + 4;
constexpr uint64_t kFrameDataBytes = 4 + 4 + 8;
constexpr int kCameraSensorType = 0;

void ReadCameras(const std::filesystem::path& path, SparseModel* model) {
  ByteReader reader(path);
  const uint64_t num_cameras = reader.ReadCount(kMinCameraBytes, "cameras");
  for (uint64_t i = 0; i < num_cameras; ++i) {
    const uint32_t camera_id = reader.Read<uint32_t>("a camera");
    const int model_id = reader.Read<int>("a camera");
    const uint64_t width = reader.Read<uint64_t>("a camera");
    const uint64_t height = reader.Read<uint64_t>("a camera");
    const CameraModelInfo* info = FindCameraModel(model_id);
    if (info == nullptr) {
      throw FileError(
          path, fmt::format("camera {} has the unknown model {}; {}", camera_id,
                            model_id, kUndistort));
    }
    std::vector<double> params(info->num_params);
    reader.Read(params.data(), params.size() * sizeof(double), "a camera");
    model->cameras[camera_id] = MakeSparseCamera(*info, width, height, params);
  }
  reader.ExpectEnd();
}

// qw, qx, qy, qz, tx, ty, tz
void ReadPose(ByteReader* reader, Eigen::Quaterniond* rotation,
              Eigen::Vector3d* translation) {
  double pose[7];
  reader->Read(pose, sizeof(pose), "a pose");
  *rotation =
      Eigen::Quaterniond(pose[0], pose[1], pose[2], pose[3]).normalized();
  *translation = Eigen::Vector3d(pose[4], pose[5], pose[6]);
}

std::string ReadName(ByteReader* reader) {
  std::string name;
  for (char c = reader->Read<char>("an image's name"); c != '\0';
       c = reader->Read<char>("an image's name")) {
    name.push_back(c);
  }
  return name;
}

void ReadImages(const std::filesystem::path& path, SparseModel* model) {
  ByteReader reader(path);
  const uint64_t num_images = reader.ReadCount(kMinImageBytes, "images");
  for (uint64_t i = 0; i < num_images; ++i) {
    SparseImage image;
    image.image_id = reader.Read<uint32_t>("an image");
    ReadPose(&reader, &image.cam_from_world_rotation,
             &image.cam_from_world_translation);
    image.camera_id = reader.Read<uint32_t>("an image");
    image.name = ReadName(&reader);
    const uint64_t num_points2D =
        reader.ReadCount(kPoint2DBytes, "2D points of an image");
    reader.Skip(num_points2D * kPoint2DBytes, "an image's 2D points");
    model->images.push_back(std::move(image));
  }
  reader.ExpectEnd();
}

void ReadPoints3D(const std::filesystem::path& path, SparseModel* model) {
  ByteReader reader(path);
  const uint64_t num_points = reader.ReadCount(kMinPoint3DBytes, "3D points");
  model->point_positions.reserve(num_points);
  model->point_colors.reserve(num_points);
  model->track_image_ids.offsets.reserve(num_points + 1);
  for (uint64_t i = 0; i < num_points; ++i) {
    reader.Skip(sizeof(uint64_t), "a 3D point");  // its id
    double position[3];
    reader.Read(position, sizeof(position), "a 3D point");
    model->point_positions.push_back(
        Eigen::Vector3d(position[0], position[1], position[2]).cast<float>());
    model->point_colors.push_back(reader.Read<Color>("a 3D point"));
    reader.Skip(sizeof(double), "a 3D point");  // its error
    const uint64_t track_length =
        reader.ReadCount(kTrackElementBytes, "track elements of a 3D point");
    for (uint64_t j = 0; j < track_length; ++j) {
      model->track_image_ids.values.push_back(reader.Read<uint32_t>("a track"));
      reader.Skip(sizeof(uint32_t), "a track");  // the 2D point's index
    }
    model->track_image_ids.EndRow();
  }
  reader.ExpectEnd();
}

void ReadFrames(const std::filesystem::path& path, SparseModel* model) {
  ByteReader reader(path);
  const uint64_t num_frames = reader.ReadCount(kMinFrameBytes, "frames");
  for (uint64_t i = 0; i < num_frames; ++i) {
    SparseFrame frame;
    frame.frame_id = reader.Read<uint32_t>("a frame");
    reader.Skip(4 + 7 * 8, "a frame");  // its rig's id and pose
    const uint32_t num_data = reader.Read<uint32_t>("a frame");
    if (num_data > reader.Remaining() / kFrameDataBytes) {
      throw FileError(
          path,
          fmt::format("truncated or damaged: a frame of {} images", num_data));
    }
    std::vector<std::tuple<uint32_t, uint64_t>> data;  // sensor id, image id
    for (uint32_t j = 0; j < num_data; ++j) {
      const int sensor_type = reader.Read<int>("a frame");
      const uint32_t sensor_id = reader.Read<uint32_t>("a frame");
      const uint64_t data_id = reader.Read<uint64_t>("a frame");
      if (sensor_type == kCameraSensorType) {
        data.emplace_back(sensor_id, data_id);
      }
    }
    std::sort(data.begin(), data.end());
    for (const auto& [sensor_id, data_id] : data) {
      frame.image_ids.push_back(static_cast<uint32_t>(data_id));
    }
    model->frames.push_back(std::move(frame));
  }
  reader.ExpectEnd();
}

}  // namespace

SparseModel ReadBinarySparseModel(const std::filesystem::path& folder) {
  SparseModel model;
  ReadCameras(folder / "cameras.bin", &model);
  ReadImages(folder / "images.bin", &model);
  ReadPoints3D(folder / "points3D.bin", &model);
  if (std::filesystem::exists(folder / "frames.bin")) {
    ReadFrames(folder / "frames.bin", &model);
  }
  return model;
}

}  // namespace colmap_ext
