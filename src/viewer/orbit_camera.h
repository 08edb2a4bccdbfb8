#pragma once

#include <array>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "scene/view.h"
#include "viewer/shown_scene.h"

namespace colmap_ext {

// A camera that the user moves around a point of the scene. Positions in the
// picture are in px from its upper left corner.
class OrbitCamera {
 public:
  // \param pivot  center of rotation, world frame
  OrbitCamera(View view, const Eigen::Vector3d& pivot)
      : view_(std::move(view)), pivot_(pivot) {}

  // The view in a picture of the given size, extended above and below or to the
  // sides.
  View Picture(int width, int height) const;

  const Eigen::Vector3d& Pivot() const { return pivot_; }

  // Turns the scene around the pivot by a virtual trackball that fills the
  // picture [Shoemake1992].
  void Orbit(const Eigen::Vector2d& from, const Eigen::Vector2d& to, int width,
             int height);

  // Turns around an axis through the pivot. Radians, world frame.
  void Turn(double angle, const Eigen::Vector3d& axis);

  // Moves the scene with the mouse; points at the pivot's depth follow it.
  void Pan(const Eigen::Vector2d& from, const Eigen::Vector2d& to, int width,
           int height);

  // Moves towards the pivot by a fraction of the distance.
  // \param steps  of a wheel; less than 0: away
  void Zoom(double steps);

 private:
  View view_;
  Eigen::Vector3d pivot_;
};

// Point on the viewing axis at the depth of `point` or, if that is behind the
// camera, at its distance.
Eigen::Vector3d PivotBefore(const View& view, const Eigen::Vector3d& point);

// Interpolates between two views of the same size.
// \param share  0: the first ... 1: the second, exactly
View BetweenViews(const View& first, const View& second, double share);

// A camera that sees the whole mesh; see pictures/pictures.h.
OrbitCamera FirstCamera(const ShownMesh& mesh, int width, int height);

// The upward direction: the mean of the cameras; without cameras, of the view.
Eigen::Vector3d Upwards(const std::vector<View>& cameras, const View& view);

// Corners of an image on a plane in front of its camera: upper left, upper
// right, lower left, lower right; world frame, scene units.
// \param depth  of the plane, scene units
std::array<Eigen::Vector3d, 4> ImageCorners(const View& view, double depth);

// Ends of the lines that show cameras, [2 L], world frame.
std::vector<Eigen::Vector3f> FrustumLines(const std::vector<View>& views,
                                          double depth);

// Distance of drawn images from their cameras at which they are large but do
// not hide each other, scene units.
double FrustumDepth(const std::vector<View>& views);

}  // namespace colmap_ext
