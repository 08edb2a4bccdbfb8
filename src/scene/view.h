#pragma once

#include <optional>
#include <string>

#include <Eigen/Core>

namespace colmap_ext {

// A pinhole camera with its pose. Pixel coordinates (u, v) are px, u to the
// right, v down. As in COLMAP's camera models, the centre of the first (upper
// left) pixel is (0.5, 0.5): pixel (row, col) covers [col, col + 1) x
// [row, row + 1). The camera's frame has x to the right, y down, z forward.
struct View {
  std::string name;  // of the image, relative to the folder of the images
  int width = 0;     // of the image, px
  int height = 0;    // of the image, px
  double fx = 1;     // focal lengths, px
  double fy = 1;
  double cx = 0;  // principal point, px
  double cy = 0;
  Eigen::Matrix3d cam_from_world_rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d cam_from_world_translation = Eigen::Vector3d::Zero();

  Eigen::Vector3d CamFromWorld(const Eigen::Vector3d& point) const {
    return cam_from_world_rotation * point + cam_from_world_translation;
  }

  // Camera centre in the world frame.
  Eigen::Vector3d Center() const {
    return -(cam_from_world_rotation.transpose() * cam_from_world_translation);
  }

  // Pixel coordinates of a point in the camera's frame.
  // \pre point.z() > 0
  Eigen::Vector2d ImageFromCam(const Eigen::Vector3d& point) const {
    return {fx * point.x() / point.z() + cx, fy * point.y() / point.z() + cy};
  }

  // From a direction in the world frame to the homogeneous pixel coordinates of
  // its image.
  Eigen::Matrix3d PixelFromRay() const {
    Eigen::Matrix3d pixel_from_cam;
    pixel_from_cam << fx, 0, cx, 0, fy, cy, 0, 0, 1;
    return pixel_from_cam * cam_from_world_rotation;
  }

  // From pixel coordinates (u, v, 1) to the direction in the world frame, with
  // a z of 1 in the camera's frame.
  Eigen::Matrix3d RayFromPixel() const {
    Eigen::Matrix3d cam_from_pixel;
    cam_from_pixel << 1 / fx, 0, -cx / fx, 0, 1 / fy, -cy / fy, 0, 0, 1;
    return cam_from_world_rotation.transpose() * cam_from_pixel;
  }
};

// Whether a pixel keeps a distance from the image's border, px.
inline bool IsWithin(const View& view, const Eigen::Vector2d& pixel,
                     double border) {
  return pixel.x() >= border && pixel.y() >= border &&
         pixel.x() < view.width - border && pixel.y() < view.height - border;
}

// The image point that a point of the world is seen at; nothing if it is behind
// the camera or outside of the image.
inline std::optional<Eigen::Vector2d> PixelInImage(
    const View& view, const Eigen::Vector3d& point) {
  const Eigen::Vector3d in_camera = view.CamFromWorld(point);
  if (!(in_camera.z() > 0)) {
    return std::nullopt;
  }
  const Eigen::Vector2d pixel = view.ImageFromCam(in_camera);
  return IsWithin(view, pixel, 0) ? std::optional(pixel) : std::nullopt;
}

// Direction in the world frame of the ray through an image point, with a z of 1
// in the camera's frame, so that distances along it are depths.
// \param u, v pixel coordinates
inline Eigen::Vector3f RayDirection(const View& view, double u, double v) {
  const Eigen::Vector3d in_camera((u - view.cx) / view.fx,
                                  (v - view.cy) / view.fy, 1);
  return (view.cam_from_world_rotation.transpose() * in_camera).cast<float>();
}

// The view with its image scaled to another size, px.
inline View ResizeView(const View& view, int width, int height) {
  const double scale_x = 1.0 * width / view.width;
  const double scale_y = 1.0 * height / view.height;
  View resized = view;
  resized.width = width;
  resized.height = height;
  resized.fx *= scale_x;
  resized.cx *= scale_x;
  resized.fy *= scale_y;
  resized.cy *= scale_y;
  return resized;
}

// Returns a camera at `eye` that looks at `target`, which is shown in the
// middle of the image, with `up` upwards in the image. Where `up` is parallel
// to the camera's axis, it is any direction.
// \param eye, target  world frame, scene units
// \param width, height, focal_length  px
// \pre eye != target
View LookAtView(const Eigen::Vector3d& eye, const Eigen::Vector3d& target,
                const Eigen::Vector3d& up, int width, int height,
                double focal_length);

}  // namespace colmap_ext
