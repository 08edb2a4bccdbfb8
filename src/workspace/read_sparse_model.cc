// COLMAP's binary and text model formats: https://colmap.github.io/format.html,
// and src/colmap/scene/reconstruction_io_*.cc for frames and rigs.

#include <algorithm>
#include <charconv>
#include <fstream>
#include <tuple>

#include <fmt/format.h>

#include "formats/byte_reader.h"
#include "workspace/sparse_model.h"

namespace colmap_ext {
namespace {

constexpr int kCameraSensorType = 0;

// The values of a binary file, whose records and lists follow their counts.
class BinarySource {
 public:
  static constexpr const char* kExtension = ".bin";

  // \param what  the records are, for messages
  // \param min_bytes  of a record
  BinarySource(const std::filesystem::path& path, const char* what,
               uint64_t min_bytes)
      : reader_(path),
        what_(what),
        num_records_(reader_.ReadCount(min_bytes, what)) {}

  // Goes to the next record.
  bool Next() {
    if (num_records_ == 0) {
      reader_.ExpectEnd();
      return false;
    }
    --num_records_;
    return true;
  }

  template <typename T>
  T Number() {
    return reader_.Read<T>(what_);
  }

  std::string Name() {
    std::string name;
    for (char c = Number<char>(); c != '\0'; c = Number<char>()) {
      name.push_back(c);
    }
    return name;
  }

  const CameraModelInfo* Model() {
    const int model_id = Number<int>();
    const CameraModelInfo* info = FindCameraModel(model_id);
    if (info == nullptr) {
      reader_.Throw(
          fmt::format("unknown camera model {}; {}", model_id, kUndistort));
    }
    return info;
  }

  int SensorType() { return Number<int>(); }

  void BeginList(uint64_t bytes_each, bool /*has_line*/ = false) {
    num_items_ = reader_.ReadCount(bytes_each, what_);
  }
  bool InList() { return num_items_ > 0 && num_items_-- > 0; }
  void SkipList(uint64_t bytes_each) {
    reader_.Skip(num_items_ * bytes_each, what_);
  }

 private:
  ByteReader reader_;
  const char* what_;
  uint64_t num_records_;
  uint64_t num_items_ = 0;
};

// The values of a text file, a line for each record, with the line's number in
// every complaint.
class TextSource {
 public:
  static constexpr const char* kExtension = ".txt";

  TextSource(const std::filesystem::path& path, const char* /*what*/,
             uint64_t /*min_bytes*/)
      : path_(path) {
    ExpectRegularFile(path);
    file_.open(path);
    if (!file_) {
      throw FileError(path, "cannot be read");
    }
  }

  // Goes to the next line that is neither empty nor a comment.
  bool Next() {
    while (NextLine()) {
      if (HasItem() && line_[position_] != '#') {
        return true;
      }
    }
    return false;
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

  std::string Name() { return Item(); }

  const CameraModelInfo* Model() {
    const std::string name = Item();
    const CameraModelInfo* info = FindCameraModel(name);
    if (info == nullptr) {
      Throw("unknown camera model " + name + "; " + kUndistort);
    }
    return info;
  }

  int SensorType() { return Item() == "CAMERA" ? kCameraSensorType : 1; }

  // A list fills the rest of the line, or a line of its own.
  void BeginList(uint64_t /*bytes_each*/, bool has_line = false) {
    if (has_line && !NextLine()) {
      Throw("truncated: the line of the image's 2D points is missing");
    }
  }
  bool InList() { return HasItem(); }
  void SkipList(uint64_t /*bytes_each*/) {}

 private:
  // Goes to the next line, whatever it holds.
  bool NextLine() {
    position_ = 0;
    ++line_number_;
    return static_cast<bool>(std::getline(file_, line_));
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

  [[noreturn]] void Throw(const std::string& message) const {
    throw FileError(path_, fmt::format("line {}: {}", line_number_, message));
  }

  std::filesystem::path path_;
  std::ifstream file_;
  std::string line_;
  size_t line_number_ = 0;
  size_t position_ = 0;  // in the line
};

template <typename Source, typename... Numbers>
void Read(Source* source, Numbers*... numbers) {
  ((*numbers = source->template Number<Numbers>()), ...);
}

template <typename Source>
void ReadCameras(Source source, SparseModel* model) {
  while (source.Next()) {
    uint32_t camera_id = 0;
    Read(&source, &camera_id);
    const CameraModelInfo* info = source.Model();
    uint64_t width = 0;
    uint64_t height = 0;
    Read(&source, &width, &height);
    std::vector<double> params(info->num_params);
    for (double& param : params) {
      Read(&source, &param);
    }
    model->cameras[camera_id] = MakeSparseCamera(*info, width, height, params);
  }
}

template <typename Source>
void ReadPose(Source* source, Eigen::Quaterniond* rotation,
              Eigen::Vector3d* translation) {
  Eigen::Quaterniond& q = *rotation;
  Eigen::Vector3d& t = *translation;
  Read(source, &q.w(), &q.x(), &q.y(), &q.z(), &t.x(), &t.y(), &t.z());
  q.normalize();
}

template <typename Source>
void ReadImages(Source source, SparseDetail detail, SparseModel* model) {
  constexpr uint64_t kObservationBytes = 8 + 8 + 8;
  while (source.Next()) {
    SparseImage& image = model->images.emplace_back();
    Read(&source, &image.image_id);
    ReadPose(&source, &image.cam_from_world_rotation,
             &image.cam_from_world_translation);
    Read(&source, &image.camera_id);
    image.name = source.Name();
    source.BeginList(kObservationBytes, /*has_line=*/true);
    if (detail != SparseDetail::kAll) {
      source.SkipList(kObservationBytes);
      continue;
    }
    while (source.InList()) {
      SparseObservation& observation = image.observations.emplace_back();
      int64_t point_id = -1;  // where it shows none
      Read(&source, &observation.pixel.x(), &observation.pixel.y(), &point_id);
      observation.point_id = static_cast<uint64_t>(point_id);
    }
  }
}

template <typename Source>
void ReadPoints3D(Source source, SparseDetail detail, SparseModel* model) {
  const bool is_all = detail == SparseDetail::kAll;
  while (source.Next()) {
    uint64_t point_id = 0;
    Eigen::Vector3d position;
    Color& color = model->point_colors.emplace_back();
    double error = 0;
    Read(&source, &point_id, &position.x(), &position.y(), &position.z(),
         &color[0], &color[1], &color[2], &error);
    model->point_positions.push_back(position.cast<float>());
    source.BeginList(4 + 4);
    while (source.InList()) {
      uint32_t observation = 0;
      Read(&source, &model->track_image_ids.values.emplace_back(),
           &observation);
      if (is_all) {
        model->track_observations.push_back(observation);
      }
    }
    model->track_image_ids.EndRow();
    if (is_all) {
      model->point_ids.push_back(point_id);
      model->exact_positions.push_back(position);
    }
  }
}

template <typename Source>
void ReadFrames(Source source, SparseModel* model) {
  while (source.Next()) {
    SparseFrame& frame = model->frames.emplace_back();
    Read(&source, &frame.frame_id, &frame.rig_id);
    ReadPose(&source, &frame.rig_from_world_rotation,
             &frame.rig_from_world_translation);
    uint32_t num_data = 0;
    Read(&source, &num_data);
    std::vector<std::tuple<uint32_t, uint64_t>> images;  // with their sensors
    for (uint32_t i = 0; i < num_data; ++i) {
      SparseData& data = frame.data.emplace_back();
      data.sensor_type = source.SensorType();
      Read(&source, &data.sensor_id, &data.data_id);
      if (data.sensor_type == kCameraSensorType) {
        images.emplace_back(data.sensor_id, data.data_id);
      }
    }
    std::ranges::sort(images);
    for (const auto& [sensor_id, image_id] : images) {
      frame.image_ids.push_back(static_cast<uint32_t>(image_id));
    }
  }
}

template <typename Source>
void ReadRigs(Source source, SparseModel* model) {
  while (source.Next()) {
    SparseRig& rig = model->rigs.emplace_back();
    uint32_t num_sensors = 0;
    Read(&source, &rig.rig_id, &num_sensors);
    for (uint32_t i = 0; i < num_sensors; ++i) {
      SparseSensor& sensor = rig.sensors.emplace_back();
      sensor.sensor_type = source.SensorType();
      Read(&source, &sensor.sensor_id);
      if (i > 0) {
        Read(&source, &sensor.has_pose);
      }
      if (sensor.has_pose != 0) {
        ReadPose(&source, &sensor.rotation, &sensor.translation);
      }
    }
  }
}

template <typename Source>
SparseModel ReadModel(const std::filesystem::path& folder,
                      SparseDetail detail) {
  const auto path = [&](const std::string& name) {
    return folder / (name + Source::kExtension);
  };
  SparseModel model;
  ReadCameras(Source(path("cameras"), "cameras", 4 + 4 + 8 + 8 + 2 * 8),
              &model);
  ReadImages(Source(path("images"), "images", 4 + 7 * 8 + 4 + 1 + 8), detail,
             &model);
  ReadPoints3D(Source(path("points3D"), "3D points", 8 + 3 * 8 + 3 + 8 + 8),
               detail, &model);
  if (std::filesystem::exists(path("frames"))) {
    if (detail == SparseDetail::kAll) {
      ReadRigs(Source(path("rigs"), "rigs", 4 + 4), &model);
    }
    ReadFrames(Source(path("frames"), "frames", 4 + 4 + 7 * 8 + 4), &model);
  }
  return model;
}

}  // namespace

SparseModel ReadSparseModelFiles(const std::filesystem::path& folder,
                                 bool is_binary, SparseDetail detail) {
  return is_binary ? ReadModel<BinarySource>(folder, detail)
                   : ReadModel<TextSource>(folder, detail);
}

}  // namespace colmap_ext
