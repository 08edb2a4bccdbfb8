#pragma once

#include <Eigen/Core>

#include "cameras/camera_set.h"
#include "scene/view.h"

namespace colmap_ext {

// The derivative of View::ImageFromCam() by the point, px / scene unit.
// \param p  camera frame
// \pre p.z() > 0
Eigen::Matrix<double, 2, 3> ProjectionJacobian(const View& view,
                                               const Eigen::Vector3d& p);

// Where image j shows the point of a plane that a fixed pixel of image i shows,
// and how that changes (docs/method.md, section 7.7). All in px.
struct ShiftJacobian {
  using ByPose = Eigen::Matrix<double, 2, 6>;        // columns: PoseStep
  using ByIntrinsics = Eigen::Matrix<double, 2, 3>;  // columns: IntrinsicsStep

  Eigen::Vector2d pixel_j;
  ByPose by_pose_i;
  ByPose by_pose_j;
  ByIntrinsics by_intrinsics_i;
  ByIntrinsics by_intrinsics_j;
  Eigen::Vector2d by_displacement;  // of the plane along its normal, px / scene
                                    // unit; the direction of the epipolar line
  Eigen::Matrix2d by_pixel_i;       // the warp from i to j
};

// \param pixel_i  px in image i
// \param point  that it shows, world
// \param normal  of the plane, unit
// \pre the point lies before both cameras, and the plane is not seen edge-on
ShiftJacobian ComputeShiftJacobian(const View& view_i, const View& view_j,
                                   const Eigen::Vector3d& point,
                                   const Eigen::Vector3d& normal);

}  // namespace colmap_ext
