#include "viewer/orbit_camera.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "pictures/picture_views.h"

namespace colmap_ext {

namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// The point of the ball under the finger, in the camera's frame; outside of it
// that on its rim.
Vector3d OnBall(const Vector2d& place, int width, int height) {
  const double radius = 0.5 * std::min(width, height);
  const Vector2d flat = (place - 0.5 * Vector2d(width, height)) / radius;
  const double length = flat.norm();
  if (length >= 1) {
    return {flat.x() / length, flat.y() / length, 0};
  }
  return {flat.x(), flat.y(), -std::sqrt(1 - length * length)};
}

// Moves a camera by a motion of the world's points.
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
  constexpr double kStep = 0.85;  // of the distance; a choice
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

}  // namespace colmap_ext
