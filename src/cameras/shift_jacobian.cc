#include "cameras/shift_jacobian.h"

namespace colmap_ext {

namespace {

Eigen::Matrix3d CrossMatrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d matrix;
  matrix << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return matrix;
}

}  // namespace

Eigen::Matrix<double, 2, 3> ProjectionJacobian(const View& view,
                                               const Eigen::Vector3d& p) {
  Eigen::Matrix<double, 2, 3> jacobian;
  jacobian << view.fx / p.z(), 0, -view.fx * p.x() / (p.z() * p.z()),  //
      0, view.fy / p.z(), -view.fy * p.y() / (p.z() * p.z());
  return jacobian;
}

// In the frame of i the pixel's ray is q, z(q) = 1, and the point p = z q. As
// the camera makes the step (w, v), the point that stays on the ray moves by
// R_i^T (p x w - v) in the world, and along the ray back to the plane, which
// together is the projection along the ray onto the plane.
ShiftJacobian ComputeShiftJacobian(const View& view_i, const View& view_j,
                                   const Eigen::Vector3d& point,
                                   const Eigen::Vector3d& normal) {
  const Eigen::Vector3d p = view_i.CamFromWorld(point);
  const Eigen::Vector3d in_j = view_j.CamFromWorld(point);
  const Eigen::Matrix3d world_from_i =
      view_i.cam_from_world_rotation.transpose();
  const Eigen::Vector3d ray = world_from_i * (p / p.z());
  const double facing = normal.dot(ray);
  const Eigen::Matrix3d onto_plane =
      Eigen::Matrix3d::Identity() - ray * normal.transpose() / facing;
  const Eigen::Matrix<double, 2, 3> by_j = ProjectionJacobian(view_j, in_j);
  const Eigen::Matrix<double, 2, 3> by_point =
      by_j * view_j.cam_from_world_rotation;
  const Eigen::Matrix<double, 2, 3> by_point_in_i =
      by_point * onto_plane * world_from_i;

  ShiftJacobian jacobian;
  jacobian.pixel_j = view_j.ImageFromCam(in_j);
  jacobian.by_pose_i << by_point_in_i * CrossMatrix(p), -by_point_in_i;
  jacobian.by_pose_j << -by_j * CrossMatrix(in_j), by_j;
  jacobian.by_displacement = by_point * ray / facing;
  jacobian.by_pixel_i.col(0) = by_point_in_i.col(0) * (p.z() / view_i.fx);
  jacobian.by_pixel_i.col(1) = by_point_in_i.col(1) * (p.z() / view_i.fy);
  // A longer focal length and a moved principal point turn the pixel's ray.
  jacobian.by_intrinsics_i << -by_point_in_i.leftCols<2>() * p.head<2>(),
      -by_point_in_i.leftCols<2>() * p.z();
  const Eigen::Vector2d from_center =
      jacobian.pixel_j - Eigen::Vector2d(view_j.cx, view_j.cy);
  jacobian.by_intrinsics_j << from_center.x(), view_j.fx, 0,  //
      from_center.y(), 0, view_j.fy;
  return jacobian;
}

}  // namespace colmap_ext
