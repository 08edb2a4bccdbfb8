#include "viewer/picture_projection.h"

#include <Eigen/Core>

namespace colmap_ext {

void SetEye(const PictureProjection& projection, Program* program) {
  const Eigen::Vector3d center = projection.view.Center();
  const Eigen::Vector3f eye = center.cast<float>();
  program->Set("eye", eye);
  program->Set("eye_rest",
               Eigen::Vector3f((center - eye.cast<double>()).cast<float>()));
}

void SetProjection(const PictureProjection& projection, Program* program) {
  const View& view = projection.view;
  program->Set("cam_from_world_rotation",
               Eigen::Matrix3f(view.cam_from_world_rotation.cast<float>()));
  program->Set("focal", Eigen::Vector2f(view.fx, view.fy));
  program->Set("principal", Eigen::Vector2f(view.cx, view.cy));
  program->Set("size", Eigen::Vector2f(view.width, view.height));
  program->Set("near", static_cast<float>(projection.near));
}

}  // namespace colmap_ext
