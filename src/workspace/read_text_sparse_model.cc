// COLMAP's text model format: https://colmap.github.io/format.html, and
// src/colmap/scene/reconstruction_io_text.cc for frames.txt and rigs.txt.

#include <algorithm>
#include <charconv>
#include <fstream>
#include <tuple>

#include <fmt/format.h>

#include "formats/byte_reader.h"
#include "formats/errors.h"
#include "workspace/sparse_model.h"

namespace colmap_ext {

namespace {

// The items of a file's lines, with the line's number in every complaint.
class LineReader {
 public:
  explicit LineReader(const std::filesystem::path& path) : path_(path) {
    ExpectRegularFile(path);
    file_.open(path);
    if (!file_) {
      throw FileError(path, "can not be read");
    }
  }

  // Goes to the next line, whatever it holds.
  bool NextLine() {
    position_ = 0;
    ++line_number_;
    return static_cast<bool>(std::getline(file_, line_));
  }

  // Goes to the next line that is neither empty nor a comment.
  bool NextDataLine() {
    while (NextLine()) {
      if (HasItem() && line_[position_] != '#') {
        return true;
      }
    }
    return false;
  }

  bool HasItem() {
    position_ =
        std::min(line_.find_first_not_of(" \t\r", position_), line_.size());
    return position_ < line_.size();
  }

  std::string Item() {
    if (!HasItem()) {
      Throw("truncated or damaged: the line is too short");
    }
    const size_t end =
        std::min(line_.find_first_of(" \t\r", position_), line_.size());
    const std::string item = line_.substr(position_, end - position_);
    position_ = end;
    return item;
  }

  template <typename T>
  T Number() {
    const std::string item = Item();
    T number{};
    const auto [end, error] =
        std::from_chars(item.data(), item.data() + item.size(), number);
    if (error != std::errc() || end != item.data() + item.size()) {
      Throw("'" + item + "' is not a number that fits here");
    }
    return number;
  }

  [[noreturn]] void Throw(const std::string& message) const {
    throw FileError(path_, fmt::format("line {}: {}", line_number_, message));
  }

 private:
  std::filesystem::path path_;
  std::ifstream file_;
  std::string line_;
  size_t line_number_ = 0;
  size_t position_ = 0;  // in the line
};

void ReadTextCameras(const std::filesystem::path& path, SparseModel* model) {
  LineReader reader(path);
  while (reader.NextDataLine()) {
    const uint32_t camera_id = reader.Number<uint32_t>();
    const std::string model_name = reader.Item();
    const uint64_t width = reader.Number<uint64_t>();
    const uint64_t height = reader.Number<uint64_t>();
    const CameraModelInfo* info = FindCameraModel(model_name);
    if (info == nullptr) {
      reader.Throw("unknown camera model " + model_name + "; " + kUndistort);
    }
    std::vector<double> params(info->num_params);
    for (double& param : params) {
      param = reader.Number<double>();
    }
    model->cameras[camera_id] = MakeSparseCamera(*info, width, height, params);
  }
}

std::vector<SparseObservation> ReadObservations(LineReader* reader) {
  std::vector<SparseObservation> observations;
  while (reader->HasItem()) {
    SparseObservation observation;
    observation.pixel.x() = reader->Number<double>();
    observation.pixel.y() = reader->Number<double>();
    // -1 where it shows none
    observation.point_id = static_cast<uint64_t>(reader->Number<int64_t>());
    observations.push_back(observation);
  }
  return observations;
}

void ReadTextImages(const std::filesystem::path& path, SparseDetail detail,
                    SparseModel* model) {
  LineReader reader(path);
  while (reader.NextDataLine()) {
    SparseImage image;
    image.image_id = reader.Number<uint32_t>();
    double pose[7];  // qw, qx, qy, qz, tx, ty, tz
    for (double& number : pose) {
      number = reader.Number<double>();
    }
    image.cam_from_world_rotation =
        Eigen::Quaterniond(pose[0], pose[1], pose[2], pose[3]).normalized();
    image.cam_from_world_translation =
        Eigen::Vector3d(pose[4], pose[5], pose[6]);
    image.camera_id = reader.Number<uint32_t>();
    image.name = reader.Item();
    if (!reader.NextLine()) {
      reader.Throw("truncated: the line of the image's 2D points is missing");
    }
    if (detail == SparseDetail::kAll) {
      image.observations = ReadObservations(&reader);
    }
    model->images.push_back(std::move(image));
  }
}

void ReadTextPoints3D(const std::filesystem::path& path, SparseDetail detail,
                      SparseModel* model) {
  const bool is_all = detail == SparseDetail::kAll;
  LineReader reader(path);
  while (reader.NextDataLine()) {
    const uint64_t point_id = reader.Number<uint64_t>();
    Eigen::Vector3d position;
    for (double& coordinate : position) {
      coordinate = reader.Number<double>();
    }
    Color color;
    for (uint8_t& channel : color) {
      channel = static_cast<uint8_t>(reader.Number<int>());
    }
    reader.Number<double>();  // its error
    while (reader.HasItem()) {
      model->track_image_ids.values.push_back(reader.Number<uint32_t>());
      const uint32_t observation = reader.Number<uint32_t>();
      if (is_all) {
        model->track_observations.push_back(observation);
      }
    }
    if (is_all) {
      model->point_ids.push_back(point_id);
      model->exact_positions.push_back(position);
    }
    model->point_positions.push_back(position.cast<float>());
    model->point_colors.push_back(color);
    model->track_image_ids.EndRow();
  }
}

void ReadTextFrames(const std::filesystem::path& path, SparseModel* model) {
  LineReader reader(path);
  while (reader.NextDataLine()) {
    SparseFrame frame;
    frame.frame_id = reader.Number<uint32_t>();
    frame.rig_id = reader.Number<uint32_t>();
    for (int i = 0; i < 7; ++i) {
      reader.Number<double>();  // its rig's pose
    }
    const uint32_t num_data = reader.Number<uint32_t>();
    std::vector<std::tuple<uint32_t, uint32_t>> data;  // sensor id, image id
    for (uint32_t i = 0; i < num_data; ++i) {
      const std::string sensor_type = reader.Item();
      const uint32_t sensor_id = reader.Number<uint32_t>();
      const uint64_t data_id = reader.Number<uint64_t>();
      frame.data.push_back(
          {sensor_type == "CAMERA" ? 0 : 1, sensor_id, data_id});
      if (sensor_type == "CAMERA") {
        data.emplace_back(sensor_id, static_cast<uint32_t>(data_id));
      }
    }
    std::sort(data.begin(), data.end());
    for (const auto& [sensor_id, image_id] : data) {
      frame.image_ids.push_back(image_id);
    }
    model->frames.push_back(std::move(frame));
  }
}

void ReadTextRigs(const std::filesystem::path& path, SparseModel* model) {
  LineReader reader(path);
  while (reader.NextDataLine()) {
    SparseRig rig;
    rig.rig_id = reader.Number<uint32_t>();
    rig.num_sensors = reader.Number<uint32_t>();
    if (rig.num_sensors > 0) {
      rig.sensor_type = reader.Item() == "CAMERA" ? 0 : 1;
      rig.sensor_id = reader.Number<uint32_t>();
    }
    model->rigs.push_back(rig);
  }
}

}  // namespace

SparseModel ReadTextSparseModel(const std::filesystem::path& folder,
                                SparseDetail detail) {
  SparseModel model;
  ReadTextCameras(folder / "cameras.txt", &model);
  ReadTextImages(folder / "images.txt", detail, &model);
  ReadTextPoints3D(folder / "points3D.txt", detail, &model);
  if (detail == SparseDetail::kAll &&
      std::filesystem::exists(folder / "rigs.txt")) {
    ReadTextRigs(folder / "rigs.txt", &model);
  }
  if (std::filesystem::exists(folder / "frames.txt")) {
    ReadTextFrames(folder / "frames.txt", &model);
  }
  return model;
}

}  // namespace colmap_ext
