#include "viewer/orbit_camera.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

#include "base/percentile.h"
#include "pictures/pictures.h"

namespace colmap_ext {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// The point of the trackball at a position, in the camera's frame; outside of
// the ball the point on its rim.
Vector3d OnBall(const Vector2d& place, int width, int height) {
  const double radius = 0.5 * std::min(width, height);
  const Vector2d flat = (place - 0.5 * Vector2d(width, height)) / radius;
  const double length = flat.norm();
  if (length >= 1) {
    return {flat.x() / length, flat.y() / length, 0};
  }
  return {flat.x(), flat.y(), -std::sqrt(1 - length * length)};
}

// Moves a camera as if the world rotated around a center.
void MoveWorld(const Eigen::Matrix3d& rotation, const Vector3d& center,
               View* view) {
  const Vector3d eye =
      center + rotation.transpose() * (view->Center() - center);
  view->cam_from_world_rotation = view->cam_from_world_rotation * rotation;
  view->cam_from_world_translation = -(view->cam_from_world_rotation * eye);
}

void SetCenter(const Vector3d& center, View* view) {
  view->cam_from_world_translation = -(view->cam_from_world_rotation * center);
}

}  // namespace

View OrbitCamera::Picture(int width, int height) const {
  return CropView(view_, 1, 0.5, 0.5, width, height);
}

void OrbitCamera::Orbit(const Vector2d& from, const Vector2d& to, int width,
                        int height) {
  const Eigen::Quaterniond in_camera = Eigen::Quaterniond::FromTwoVectors(
      OnBall(from, width, height), OnBall(to, width, height));
  const Eigen::Matrix3d& rotation = view_.cam_from_world_rotation;
  // Shoemake's ball turns by twice the angle, so that every rotation is one
  // drag away.
  MoveWorld(rotation.transpose() * (in_camera * in_camera).toRotationMatrix() *
                rotation,
            pivot_, &view_);
}

void OrbitCamera::Turn(double angle, const Vector3d& axis) {
  MoveWorld(Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix(),
            pivot_, &view_);
}

void OrbitCamera::Pan(const Vector2d& from, const Vector2d& to, int width,
                      int height) {
  const View picture = Picture(width, height);
  const double depth = view_.CamFromWorld(PivotBefore(view_, pivot_)).z();
  const Vector3d moved(depth * (to.x() - from.x()) / picture.fx,
                       depth * (to.y() - from.y()) / picture.fy, 0);
  const Vector3d in_world = view_.cam_from_world_rotation.transpose() * moved;
  SetCenter(view_.Center() - in_world, &view_);
  pivot_ -= in_world;
}

void OrbitCamera::Zoom(double steps) {
  constexpr double kStep = 0.85;  // of the distance; chosen by hand
  SetCenter(pivot_ + std::pow(kStep, steps) * (view_.Center() - pivot_),
            &view_);
}

Vector3d PivotBefore(const View& view, const Vector3d& point) {
  const double depth = view.CamFromWorld(point).z();
  const double distance = depth > 0 ? depth : (point - view.Center()).norm();
  return view.Center() +
         distance * view.cam_from_world_rotation.row(2).transpose();
}

View BetweenViews(const View& first, const View& second, double share) {
  if (share >= 1) {
    return second;
  }
  const auto mix = [share](double a, double b) { return a + share * (b - a); };
  View view = first;
  view.fx = mix(first.fx, second.fx);
  view.fy = mix(first.fy, second.fy);
  view.cx = mix(first.cx, second.cx);
  view.cy = mix(first.cy, second.cy);
  view.cam_from_world_rotation =
      Eigen::Quaterniond(first.cam_from_world_rotation)
          .slerp(share, Eigen::Quaterniond(second.cam_from_world_rotation))
          .toRotationMatrix();
  SetCenter(first.Center() + share * (second.Center() - first.Center()), &view);
  return view;
}

OrbitCamera FirstCamera(const ShownMesh& mesh, int width, int height) {
  const View view =
      mesh.mesh.facets.empty()
          ? AutomaticView(mesh.mesh.vertices, mesh.front, width, height)
          : AutomaticView(mesh.mesh, width, height);
  return {view, MedianPoint(mesh.mesh.vertices)};
}

Eigen::Vector3d Upwards(const std::vector<View>& cameras, const View& view) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const View& camera : cameras) {
    sum -= camera.cam_from_world_rotation.row(1).transpose();
  }
  // Cameras in all directions have no common one. Chosen by hand.
  constexpr double kMinMean = 0.3;
  if (sum.norm() > kMinMean * static_cast<double>(cameras.size())) {
    return sum.normalized();
  }
  return -view.cam_from_world_rotation.row(1).transpose();
}

std::array<Eigen::Vector3d, 4> ImageCorners(const View& view, double depth) {
  const Eigen::Matrix3d ray_from_pixel = view.RayFromPixel();
  std::array<Eigen::Vector3d, 4> corners;
  for (int i = 0; i < 4; ++i) {
    const int below = i / 2;
    const Eigen::Vector3d pixel(i % 2 * view.width, below * view.height, 1);
    corners[i] = view.Center() + depth * (ray_from_pixel * pixel);
  }
  return corners;
}

std::vector<Eigen::Vector3f> FrustumLines(const std::vector<View>& views,
                                          double depth) {
  constexpr std::array<int, 8> kAround = {0, 1, 1, 3, 3, 2, 2, 0};
  std::vector<Eigen::Vector3f> ends;
  for (const View& view : views) {
    const std::array<Eigen::Vector3d, 4> corners = ImageCorners(view, depth);
    for (const Eigen::Vector3d& corner : corners) {
      ends.emplace_back(view.Center().cast<float>());
      ends.emplace_back(corner.cast<float>());
    }
    for (const int i : kAround) {
      ends.emplace_back(corners[i].cast<float>());
    }
  }
  return ends;
}

double FrustumDepth(const std::vector<View>& views) {
  constexpr double kShare = 0.4;     // of the distance to the next camera
  constexpr size_t kMaxAsked = 200;  // cameras; chosen by hand
  std::vector<double> distances;
  for (size_t i = 0; i < std::min(views.size(), kMaxAsked); ++i) {
    double nearest = std::numeric_limits<double>::infinity();
    for (size_t j = 0; j < views.size(); ++j) {
      const double distance = (views[i].Center() - views[j].Center()).norm();
      nearest = distance > 0 ? std::min(nearest, distance) : nearest;
    }
    if (nearest < std::numeric_limits<double>::infinity()) {
      distances.push_back(nearest);
    }
  }
  return distances.empty() ? 1 : kShare * Median(&distances);
}

}  // namespace colmap_ext
