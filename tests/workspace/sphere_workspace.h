#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <numeric>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "scene/images.h"
#include "scene/point_cloud.h"
#include "scene/view.h"
#include "tests/formats/test_files.h"

namespace colmap_ext {

// The values of a file of the sparse model: little-endian numbers, or lines of
// text.
class ModelWriter {
 public:
  explicit ModelWriter(bool is_binary)
      : is_binary_(is_binary), bytes_(is_binary ? "" : "# a comment\n") {}

  template <typename... Numbers>
  void Add(Numbers... numbers) {
    (AddNumber(numbers), ...);
  }

  // What is a number in binary files and a word in text.
  void Add(int32_t number, const char* word) {
    if (is_binary_) {
      Add(number);
    } else {
      bytes_ += word + std::string(" ");
    }
  }

  void AddName(const std::string& name) {
    bytes_ += name + (is_binary_ ? '\0' : ' ');
  }

  void AddPose(const View& view) {
    const Eigen::Quaterniond q(view.cam_from_world_rotation);
    const Eigen::Vector3d& t = view.cam_from_world_translation;
    Add(q.w(), q.x(), q.y(), q.z(), t.x(), t.y(), t.z());
  }

  // In text, lists end with their lines.
  void BeginList(uint64_t size) {
    if (is_binary_) {
      Add(size);
    }
  }

  void EndLine() { bytes_ += is_binary_ ? "" : "\n"; }

  const std::string& Bytes() const { return bytes_; }

 private:
  template <typename T>
  void AddNumber(T number) {
    if (is_binary_) {
      Append(number, &bytes_);
      return;
    }
    std::ostringstream text;
    text.precision(17);
    text << +number << ' ';
    bytes_ += text.str();
  }

  bool is_binary_;
  std::string bytes_;
};

inline constexpr int kNumSpherePoints = 1500;
inline constexpr int kSphereWidth = 80;     // px
inline constexpr int kSphereHeight = 60;    // px
inline constexpr double kSphereFocal = 90;  // px
inline constexpr uint32_t kSphereCameraId = 7;

inline View SphereView(const std::string& name, double angle) {
  View view =
      LookAtView({4 * std::cos(angle), 4 * std::sin(angle), 1}, {0, 0, 0},
                 {0, 0, 1}, kSphereWidth, kSphereHeight, kSphereFocal);
  view.name = name;
  return view;
}

inline std::optional<Eigen::Vector3d> FirstOfSphere(
    const Eigen::Vector3d& origin, const Eigen::Vector3d& ray) {
  const double b = origin.dot(ray);
  const double discriminant = b * b - origin.squaredNorm() + 1;
  if (discriminant < 0) {
    return std::nullopt;
  }
  return origin + (-b - std::sqrt(discriminant)) * ray;
}

inline std::optional<ColorImage> ReadNetpbm(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::string magic;
  ColorImage image;
  int max_value = 0;
  file >> magic >> image.width >> image.height >> max_value;
  if (!file || max_value != 255 || (magic != "P5" && magic != "P6")) {
    return std::nullopt;
  }
  file.get();
  for (int i = 0; i < image.width * image.height; ++i) {
    Color color;
    for (uint8_t& channel : color) {
      channel = magic == "P5" && &channel != color.data()
                    ? color[0]
                    : static_cast<uint8_t>(file.get());
    }
    image.pixels.push_back(color);
  }
  return file ? std::optional(image) : std::nullopt;
}

inline std::optional<GrayImage> ReadGrayNetpbm(
    const std::filesystem::path& path) {
  const std::optional<ColorImage> color = ReadNetpbm(path);
  if (!color) {
    return std::nullopt;
  }
  GrayImage gray{color->width, color->height, {}};
  for (const Color& pixel : color->pixels) {
    gray.pixels.push_back(
        static_cast<uint8_t>((pixel[0] + pixel[1] + pixel[2]) / 3));
  }
  return gray;
}

// Colour of the sphere at a point of it, black where it is not finite.
inline Color SphereColor(const Eigen::Vector3d& point) {
  const auto channel = [](double value) {
    return static_cast<uint8_t>(
        std::isfinite(value) ? std::clamp(128 + 120 * value, 0.0, 255.0) : 0);
  };
  return {channel(std::sin(5 * point.x())), channel(std::sin(7 * point.y())),
          channel(point.z())};
}

// A tiny dense workspace: a coloured sphere and cameras in a ring around it,
// written byte by byte from the formats' documentation, independently of what
// reads it.
struct SphereWorkspace {
  struct Image {
    uint32_t image_id;
    View view;
  };

  SphereWorkspace() {
    const std::vector<uint32_t> ids = {4, 9, 2, 7, 5, 1, 8};
    for (size_t i = 0; i < ids.size(); ++i) {
      const double angle = 2 * std::numbers::pi * ids[i] / 10;
      images.push_back(
          {ids[i],
           SphereView("image" + std::to_string(ids[i]) + ".ppm", angle)});
    }
    vis_order.resize(images.size());
    std::iota(vis_order.begin(), vis_order.end(), size_t{0});
    for (int i = 0; i < kNumSpherePoints; ++i) {  // a Fibonacci spiral
      const double z = 1 - 2 * (i + 0.5) / kNumSpherePoints;
      const double angle = i * std::numbers::pi * (3 - std::sqrt(5));
      const double radius = std::sqrt(1 - z * z);
      const Eigen::Vector3d point(radius * std::cos(angle),
                                  radius * std::sin(angle), z);
      std::vector<size_t> seen_by;
      for (size_t j = 0; j < images.size(); ++j) {
        const Eigen::Vector3d ray = images[j].view.Center() - point;
        if (point.dot(ray.normalized()) > 0.2) {
          seen_by.push_back(j);
        }
      }
      if (!seen_by.empty()) {
        points.push_back(point.cast<float>());
        point_images.push_back(seen_by);
      }
    }
  }

  std::vector<Image> images;      // in the order of images.bin
  std::vector<size_t> vis_order;  // images, by their index in the .vis
  std::vector<std::vector<uint32_t>> frames;      // image ids, for frames.bin
  std::vector<Eigen::Vector3f> points;            // radius 1 around the origin
  std::vector<std::vector<size_t>> point_images;  // indices into images
  bool write_normals = true;
  bool write_images = true;

  // Three images, two sparse points and two frames, so that files are small.
  static SphereWorkspace Small() {
    SphereWorkspace sphere;
    sphere.images.resize(3);
    sphere.vis_order.resize(3);
    sphere.points.resize(20);
    sphere.point_images.assign(20, {0, 2});
    sphere.frames = {{2, 4}, {9}};
    return sphere;
  }

  void Write(const std::filesystem::path& folder) const {
    WriteModel(folder / "sparse", ".bin");
    WriteFile(folder / "fused.ply", Ply());
    WriteFile(folder / "fused.ply.vis", Vis());
    for (size_t i = 0; write_images && i < images.size(); ++i) {
      WriteFile(folder / "images" / images[i].view.name, Ppm(i));
    }
  }

  // \param extension  ".bin" or ".txt".
  void WriteModel(const std::filesystem::path& folder,
                  const std::string& extension) const {
    for (const std::string name : {"cameras", "images", "points3D", "frames"}) {
      if (name != "frames" || !frames.empty()) {
        WriteFile(folder / (name + extension), ModelFile(name + extension));
      }
    }
  }

  // \param name  cameras, images, points3D or frames, with an extension.
  std::string ModelFile(const std::string& name) const {
    ModelWriter file(name.ends_with(".bin"));
    if (name.starts_with("cameras")) {
      file.BeginList(1);
      file.Add(kSphereCameraId);
      file.Add(1, "PINHOLE");
      file.Add(uint64_t{kSphereWidth}, uint64_t{kSphereHeight}, kSphereFocal,
               kSphereFocal, kSphereWidth / 2.0, kSphereHeight / 2.0);
    } else if (name.starts_with("images")) {
      AddImages(&file);
    } else if (name.starts_with("points3D")) {
      AddPoints3D(&file);
    } else {
      AddFrames(&file);
    }
    return file.Bytes();
  }
  std::string Ply() const {
    std::string bytes =
        "ply\nformat binary_little_endian 1.0\nelement vertex " +
        std::to_string(points.size()) +
        "\nproperty float x\nproperty float y\nproperty float z\n";
    if (write_normals) {
      bytes += "property float nx\nproperty float ny\nproperty float nz\n";
    }
    bytes +=
        "property uchar red\nproperty uchar green\nproperty uchar blue\n"
        "end_header\n";
    for (const Eigen::Vector3f& point : points) {
      for (int i = 0; i < (write_normals ? 6 : 3); ++i) {
        Append(point[i % 3], &bytes);  // of a sphere they are the same
      }
      Append(SphereColor(point.cast<double>()), &bytes);
    }
    return bytes;
  }
  std::string Vis() const {
    std::vector<uint32_t> index_of_image(images.size());
    for (size_t i = 0; i < vis_order.size(); ++i) {
      index_of_image[vis_order[i]] = static_cast<uint32_t>(i);
    }
    std::string bytes;
    Append(uint64_t{points.size()}, &bytes);
    for (const std::vector<size_t>& seen_by : point_images) {
      Append(static_cast<uint32_t>(seen_by.size()), &bytes);
      for (const size_t image : seen_by) {
        Append(index_of_image[image], &bytes);
      }
    }
    return bytes;
  }
  std::string Ppm(size_t image) const {
    const View& view = images[image].view;
    std::string bytes = "P6\n" + std::to_string(view.width) + " " +
                        std::to_string(view.height) + "\n255\n";
    for (int y = 0; y < view.height; ++y) {
      for (int x = 0; x < view.width; ++x) {
        const Eigen::Vector3d ray =
            view.cam_from_world_rotation.transpose() *
            Eigen::Vector3d((x + 0.5 - view.cx) / view.fx,
                            (y + 0.5 - view.cy) / view.fy, 1);
        const auto point = FirstOfSphere(view.Center(), ray.normalized());
        Append(point ? SphereColor(*point) : Color{}, &bytes);
      }
    }
    return bytes;
  }

 private:
  void AddImages(class ModelWriter* file) const {
    file->BeginList(images.size());
    for (size_t i = 0; i < images.size(); ++i) {
      const std::vector<size_t> seen = SparsePointsOf(i);
      file->Add(images[i].image_id);
      file->AddPose(images[i].view);
      file->Add(kSphereCameraId);
      file->AddName(images[i].view.name);
      file->EndLine();
      file->BeginList(seen.size() + 1);
      file->Add(12.5, 7.5, int64_t{-1});
      for (const size_t point : seen) {
        const Eigen::Vector2d pixel = Pixel(i, point);
        file->Add(pixel.x(), pixel.y(), uint64_t{point + 1});
      }
      file->EndLine();
    }
  }
  void AddPoints3D(class ModelWriter* file) const {
    file->BeginList(NumSparsePoints());
    for (uint64_t i = 0; i < NumSparsePoints(); ++i) {
      const Eigen::Vector3d point = points[10 * i].cast<double>();
      const auto [red, green, blue] = SphereColor(point);
      file->Add(i + 1, point.x(), point.y(), point.z(), red, green, blue, 0.5);
      file->BeginList(point_images[10 * i].size());
      for (const size_t image : point_images[10 * i]) {
        file->Add(images[image].image_id, Observation(image, i));
      }
      file->EndLine();
    }
  }
  void AddFrames(class ModelWriter* file) const {
    file->BeginList(frames.size());
    for (uint32_t i = 0; i < frames.size(); ++i) {
      file->Add(i + 1, uint32_t{1});  // and the rig id
      file->AddPose(images[0].view);
      file->Add(static_cast<uint32_t>(frames[i].size() + 1));
      for (uint32_t j = 0; j < frames[i].size(); ++j) {
        file->Add(0, "CAMERA");
        file->Add(j, uint64_t{frames[i][j]});
      }
      file->Add(1, "IMU");  // whose data is no image
      file->Add(uint32_t{0}, uint64_t{3});
      file->EndLine();
    }
  }
  size_t NumSparsePoints() const { return points.size() / 10; }

  // The sparse points that an image sees.
  std::vector<size_t> SparsePointsOf(size_t image) const {
    std::vector<size_t> seen;
    for (size_t i = 0; i < NumSparsePoints(); ++i) {
      const std::vector<size_t>& seen_by = point_images[10 * i];
      if (std::ranges::find(seen_by, image) != seen_by.end()) {
        seen.push_back(i);
      }
    }
    return seen;
  }

  // Which of the image's observations is that of a sparse point that it sees,
  // and where it lies.
  uint32_t Observation(size_t image, size_t point) const {
    const std::vector<size_t> seen = SparsePointsOf(image);
    return static_cast<uint32_t>(std::ranges::find(seen, point) - seen.begin() +
                                 1);
  }
  Eigen::Vector2d Pixel(size_t image, size_t point) const {
    const View& view = images[image].view;
    return view.ImageFromCam(
        view.CamFromWorld(points[10 * point].cast<double>()));
  }
};

// Decodes the binary pictures of 8 bits of Netpbm, PPM and PGM.
inline PictureDecoder NetpbmDecoder() { return {&ReadNetpbm, &ReadGrayNetpbm}; }

}  // namespace colmap_ext
