// COLMAP's binary model format: https://colmap.github.io/format.html, and
// src/colmap/scene/reconstruction_io_binary.cc for frames.bin and rigs.bin.

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
constexpr uint64_t kMinRigBytes = 4 + 4;
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

std::vector<SparseObservation> ReadObservations(ByteReader* reader,
                                                uint64_t count) {
  std::vector<SparseObservation> observations(count);
  for (SparseObservation& observation : observations) {
    observation.pixel.x() = reader->Read<double>("a 2D point");
    observation.pixel.y() = reader->Read<double>("a 2D point");
    observation.point_id = reader->Read<uint64_t>("a 2D point");
  }
  return observations;
}

void ReadImages(const std::filesystem::path& path, SparseDetail detail,
                SparseModel* model) {
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
    if (detail == SparseDetail::kAll) {
      image.observations = ReadObservations(&reader, num_points2D);
    } else {
      reader.Skip(num_points2D * kPoint2DBytes, "an image's 2D points");
    }
    model->images.push_back(std::move(image));
  }
  reader.ExpectEnd();
}

void ReadPoints3D(const std::filesystem::path& path, SparseDetail detail,
                  SparseModel* model) {
  const bool is_all = detail == SparseDetail::kAll;
  ByteReader reader(path);
  const uint64_t num_points = reader.ReadCount(kMinPoint3DBytes, "3D points");
  model->point_positions.reserve(num_points);
  model->point_colors.reserve(num_points);
  model->track_image_ids.offsets.reserve(num_points + 1);
  for (uint64_t i = 0; i < num_points; ++i) {
    const uint64_t point_id = reader.Read<uint64_t>("a 3D point");
    Eigen::Vector3d position;
    reader.Read(position.data(), 3 * sizeof(double), "a 3D point");
    model->point_positions.push_back(position.cast<float>());
    if (is_all) {
      model->point_ids.push_back(point_id);
      model->exact_positions.push_back(position);
    }
    model->point_colors.push_back(reader.Read<Color>("a 3D point"));
    reader.Skip(sizeof(double), "a 3D point");  // its error
    const uint64_t track_length =
        reader.ReadCount(kTrackElementBytes, "track elements of a 3D point");
    for (uint64_t j = 0; j < track_length; ++j) {
      model->track_image_ids.values.push_back(reader.Read<uint32_t>("a track"));
      const uint32_t observation = reader.Read<uint32_t>("a track");
      if (is_all) {
        model->track_observations.push_back(observation);
      }
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
    frame.rig_id = reader.Read<uint32_t>("a frame");
    reader.Skip(7 * 8, "a frame");  // its rig's pose
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
      frame.data.push_back({sensor_type, sensor_id, data_id});
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

void ReadRigs(const std::filesystem::path& path, SparseModel* model) {
  ByteReader reader(path);
  const uint64_t num_rigs = reader.ReadCount(kMinRigBytes, "rigs");
  for (uint64_t i = 0; i < num_rigs; ++i) {
    SparseRig rig;
    rig.rig_id = reader.Read<uint32_t>("a rig");
    rig.num_sensors = reader.Read<uint32_t>("a rig");
    if (rig.num_sensors > 0) {
      rig.sensor_type = reader.Read<int>("a rig");
      rig.sensor_id = reader.Read<uint32_t>("a rig");
    }
    for (uint32_t j = 1; j < rig.num_sensors; ++j) {
      reader.Skip(4 + 4, "a rig's sensor");
      if (reader.Read<uint8_t>("a rig's sensor") != 0) {
        reader.Skip(7 * 8, "a rig's sensor");
      }
    }
    model->rigs.push_back(rig);
  }
  reader.ExpectEnd();
}

}  // namespace

SparseModel ReadBinarySparseModel(const std::filesystem::path& folder,
                                  SparseDetail detail) {
  SparseModel model;
  ReadCameras(folder / "cameras.bin", &model);
  ReadImages(folder / "images.bin", detail, &model);
  ReadPoints3D(folder / "points3D.bin", detail, &model);
  if (detail == SparseDetail::kAll &&
      std::filesystem::exists(folder / "rigs.bin")) {
    ReadRigs(folder / "rigs.bin", &model);
  }
  if (std::filesystem::exists(folder / "frames.bin")) {
    ReadFrames(folder / "frames.bin", &model);
  }
  return model;
}

}  // namespace colmap_ext
