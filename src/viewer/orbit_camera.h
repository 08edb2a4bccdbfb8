#pragma once

#include <Eigen/Core>

#include "scene/view.h"

namespace colmap_ext {

// A camera that is moved by hand, around a point of the scene. Places in the
// picture are px, (0, 0) is its upper left corner.
class OrbitCamera {
 public:
  // \param pivot  what it turns around, world frame
  OrbitCamera(View view, const Eigen::Vector3d& pivot)
      : view_(std::move(view)), pivot_(pivot) {}

  // What it sees in a picture of the given size: all of its view, and what is
  // above and below or to the sides of it.
  View Picture(int width, int height) const;

  const Eigen::Vector3d& Pivot() const { return pivot_; }
  void SetPivot(const Eigen::Vector3d& pivot) { pivot_ = pivot; }

  // Turns the scene around the pivot as if it were in a glass ball that fills
  // the picture and is rolled by a finger [Shoemake1992].
  void Orbit(const Eigen::Vector2d& from, const Eigen::Vector2d& to, int width,
             int height);

  // Turns around an axis through the pivot. Radians, world frame.
  void Turn(double angle, const Eigen::Vector3d& axis);

  // Moves the scene with the mouse: what is as far away as the pivot follows
  // it exactly.
  void Pan(const Eigen::Vector2d& from, const Eigen::Vector2d& to, int width,
           int height);

  // Moves towards the pivot by a share of what is left of the way.
  // \param steps  of a wheel; less than 0: away
  void Zoom(double steps);

 private:
  View view_;
  Eigen::Vector3d pivot_;
};

// The point before a camera that is as far away as another point is; where that
// is behind the camera, as far as it is away from it.
Eigen::Vector3d PivotBefore(const View& view, const Eigen::Vector3d& point);

// The way from one view to another, of the same size.
// \param share  0: the first ... 1: the second, exactly
View BetweenViews(const View& first, const View& second, double share);

}  // namespace colmap_ext
