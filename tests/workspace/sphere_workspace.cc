#include "tests/workspace/sphere_workspace.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <sstream>

#include <Eigen/Geometry>

#include "tests/formats/test_files.h"

namespace colmap_ext {

namespace {

constexpr int kNumPoints = 1500;
constexpr int kWidth = 80;     // px
constexpr int kHeight = 60;    // px
constexpr double kFocal = 90;  // px
constexpr uint32_t kCameraId = 7;

View MakeView(const std::string& name, double angle) {
  View view;
  view.name = name;
  view.width = kWidth;
  view.height = kHeight;
  view.fx = view.fy = kFocal;
  view.cx = kWidth / 2.0;
  view.cy = kHeight / 2.0;
  const Eigen::Vector3d center(4 * std::cos(angle), 4 * std::sin(angle), 1);
  const Eigen::Vector3d forward = -center.normalized();
  const Eigen::Vector3d right =
      forward.cross(Eigen::Vector3d::UnitZ()).normalized();
  view.cam_from_world_rotation << right.transpose(),
      forward.cross(right).transpose(), forward.transpose();
  view.cam_from_world_translation = -view.cam_from_world_rotation * center;
  return view;
}

std::optional<Eigen::Vector3d> IntersectSphere(const Eigen::Vector3d& origin,
                                               const Eigen::Vector3d& ray) {
  const double b = origin.dot(ray);
  const double discriminant = b * b - origin.squaredNorm() + 1;
  if (discriminant < 0) {
    return std::nullopt;
  }
  return origin + (-b - std::sqrt(discriminant)) * ray;
}

void AppendPose(const View& view, std::string* bytes) {
  const Eigen::Quaterniond q(view.cam_from_world_rotation);
  const Eigen::Vector3d& t = view.cam_from_world_translation;
  for (const double number :
       {q.w(), q.x(), q.y(), q.z(), t.x(), t.y(), t.z()}) {
    Append(number, bytes);
  }
}

std::string PoseText(const View& view) {
  const Eigen::Quaterniond q(view.cam_from_world_rotation);
  const Eigen::Vector3d& t = view.cam_from_world_translation;
  std::ostringstream text;
  text.precision(17);
  text << q.w() << " " << q.x() << " " << q.y() << " " << q.z() << " " << t.x()
       << " " << t.y() << " " << t.z();
  return text.str();
}

}  // namespace

Color SphereColor(const Eigen::Vector3d& point) {
  const auto channel = [](double value) {
    return static_cast<uint8_t>(std::clamp(128 + 120 * value, 0.0, 255.0));
  };
  return {channel(std::sin(5 * point.x())), channel(std::sin(7 * point.y())),
          channel(point.z())};
}

SphereWorkspace::SphereWorkspace() {
  const std::vector<uint32_t> ids = {4, 9, 2, 7, 5, 1, 8};
  for (size_t i = 0; i < ids.size(); ++i) {
    const double angle = 2 * std::numbers::pi * ids[i] / 10;
    images.push_back(
        {ids[i], MakeView("image" + std::to_string(ids[i]) + ".ppm", angle)});
  }
  vis_order.resize(images.size());
  std::iota(vis_order.begin(), vis_order.end(), size_t{0});
  for (int i = 0; i < kNumPoints; ++i) {  // a Fibonacci spiral
    const double z = 1 - 2 * (i + 0.5) / kNumPoints;
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

void SphereWorkspace::Write(const std::filesystem::path& folder) const {
  WriteFile(folder / "sparse" / "cameras.bin", CamerasBinary());
  WriteFile(folder / "sparse" / "images.bin", ImagesBinary());
  WriteFile(folder / "sparse" / "points3D.bin", Points3DBinary());
  if (!frames.empty()) {
    WriteFile(folder / "sparse" / "frames.bin", FramesBinary());
  }
  WriteFile(folder / "fused.ply", Ply());
  WriteFile(folder / "fused.ply.vis", Vis());
  for (size_t i = 0; write_images && i < images.size(); ++i) {
    WriteFile(folder / "images" / images[i].view.name, Ppm(i));
  }
}

std::string SphereWorkspace::CamerasBinary() const {
  std::string bytes;
  Append(uint64_t{1}, &bytes);
  Append(kCameraId, &bytes);
  Append(int32_t{1}, &bytes);  // PINHOLE
  Append(uint64_t{kWidth}, &bytes);
  Append(uint64_t{kHeight}, &bytes);
  for (const double param : {kFocal, kFocal, kWidth / 2.0, kHeight / 2.0}) {
    Append(param, &bytes);
  }
  return bytes;
}

std::string SphereWorkspace::CamerasText() const {
  std::ostringstream text;
  text << "# a comment\n"
       << kCameraId << " PINHOLE " << kWidth << " " << kHeight << " " << kFocal
       << " " << kFocal << " " << kWidth / 2.0 << " " << kHeight / 2.0 << "\n";
  return text.str();
}

// Every tenth fused point is one of the sparse model.
size_t SphereWorkspace::NumSparsePoints() const { return points.size() / 10; }

std::vector<size_t> SphereWorkspace::SparsePointsOf(size_t image) const {
  std::vector<size_t> seen;
  for (size_t i = 0; i < NumSparsePoints(); ++i) {
    const std::vector<size_t>& seen_by = point_images[10 * i];
    if (std::find(seen_by.begin(), seen_by.end(), image) != seen_by.end()) {
      seen.push_back(i);
    }
  }
  return seen;
}

// The first observation of each image belongs to no point.
uint32_t SphereWorkspace::Observation(size_t image, size_t point) const {
  const std::vector<size_t> seen = SparsePointsOf(image);
  return static_cast<uint32_t>(std::find(seen.begin(), seen.end(), point) -
                               seen.begin() + 1);
}

Eigen::Vector2d SphereWorkspace::Pixel(size_t image, size_t point) const {
  const View& view = images[image].view;
  return view.ImageFromCam(
      view.CamFromWorld(points[10 * point].cast<double>()));
}

std::string SphereWorkspace::ImagesBinary() const {
  std::string bytes;
  Append(uint64_t{images.size()}, &bytes);
  for (size_t i = 0; i < images.size(); ++i) {
    const std::vector<size_t> seen = SparsePointsOf(i);
    Append(images[i].image_id, &bytes);
    AppendPose(images[i].view, &bytes);
    Append(kCameraId, &bytes);
    bytes += images[i].view.name + '\0';
    Append(uint64_t{seen.size() + 1}, &bytes);
    Append(12.5, &bytes);
    Append(7.5, &bytes);
    Append(~uint64_t{0}, &bytes);
    for (const size_t point : seen) {
      const Eigen::Vector2d pixel = Pixel(i, point);
      Append(pixel.x(), &bytes);
      Append(pixel.y(), &bytes);
      Append(uint64_t{point + 1}, &bytes);
    }
  }
  return bytes;
}

std::string SphereWorkspace::ImagesText() const {
  std::ostringstream text;
  text.precision(17);
  text << "# a comment\n";
  for (size_t i = 0; i < images.size(); ++i) {
    text << images[i].image_id << " " << PoseText(images[i].view) << " "
         << kCameraId << " " << images[i].view.name << "\n12.5 7.5 -1";
    for (const size_t point : SparsePointsOf(i)) {
      text << " " << Pixel(i, point).transpose() << " " << point + 1;
    }
    text << "\n";
  }
  return text.str();
}

std::string SphereWorkspace::Points3DBinary() const {
  std::string bytes;
  Append(uint64_t{NumSparsePoints()}, &bytes);
  for (uint64_t i = 0; i < NumSparsePoints(); ++i) {
    Append(i + 1, &bytes);
    for (const float coordinate : points[10 * i]) {
      Append(double{coordinate}, &bytes);
    }
    Append(SphereColor(points[10 * i].cast<double>()), &bytes);
    Append(0.5, &bytes);
    Append(uint64_t{point_images[10 * i].size()}, &bytes);
    for (const size_t image : point_images[10 * i]) {
      Append(images[image].image_id, &bytes);
      Append(Observation(image, i), &bytes);
    }
  }
  return bytes;
}

std::string SphereWorkspace::Points3DText() const {
  std::ostringstream text;
  text.precision(17);
  for (size_t i = 0; i < NumSparsePoints(); ++i) {
    const Color color = SphereColor(points[10 * i].cast<double>());
    text << i + 1 << " " << points[10 * i].transpose() << " " << int{color[0]}
         << " " << int{color[1]} << " " << int{color[2]} << " 0.5";
    for (const size_t image : point_images[10 * i]) {
      text << " " << images[image].image_id << " " << Observation(image, i);
    }
    text << "\n";
  }
  return text.str();
}

std::string SphereWorkspace::FramesBinary() const {
  std::string bytes;
  Append(uint64_t{frames.size()}, &bytes);
  for (size_t i = 0; i < frames.size(); ++i) {
    Append(static_cast<uint32_t>(i + 1), &bytes);
    Append(uint32_t{1}, &bytes);  // rig id
    AppendPose(images[0].view, &bytes);
    Append(static_cast<uint32_t>(frames[i].size() + 1), &bytes);
    for (size_t j = 0; j < frames[i].size(); ++j) {
      Append(int32_t{0}, &bytes);  // a camera
      Append(static_cast<uint32_t>(j), &bytes);
      Append(uint64_t{frames[i][j]}, &bytes);
    }
    Append(int32_t{1}, &bytes);  // an IMU, whose data is no image
    Append(uint32_t{0}, &bytes);
    Append(uint64_t{3}, &bytes);
  }
  return bytes;
}

std::string SphereWorkspace::FramesText() const {
  std::ostringstream text;
  for (size_t i = 0; i < frames.size(); ++i) {
    text << i + 1 << " 1 " << PoseText(images[0].view) << " "
         << frames[i].size() + 1;
    for (size_t j = 0; j < frames[i].size(); ++j) {
      text << " CAMERA " << j << " " << frames[i][j];
    }
    text << " IMU 0 3\n";
  }
  return text.str();
}

std::string SphereWorkspace::Ply() const {
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

std::string SphereWorkspace::Vis() const {
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

std::string SphereWorkspace::Ppm(size_t image) const {
  const View& view = images[image].view;
  std::string bytes = "P6\n" + std::to_string(view.width) + " " +
                      std::to_string(view.height) + "\n255\n";
  for (int y = 0; y < view.height; ++y) {
    for (int x = 0; x < view.width; ++x) {
      const Eigen::Vector3d ray =
          view.cam_from_world_rotation.transpose() *
          Eigen::Vector3d((x + 0.5 - view.cx) / view.fx,
                          (y + 0.5 - view.cy) / view.fy, 1);
      const auto point = IntersectSphere(view.Center(), ray.normalized());
      Append(point ? SphereColor(*point) : Color{}, &bytes);
    }
  }
  return bytes;
}

}  // namespace colmap_ext
