#include "viewer/first_view.h"

#include "base/percentile.h"
#include "pictures/picture_views.h"

namespace colmap_ext {

Eigen::Vector3d Middle(const ShownMesh& mesh) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (int axis = 0; axis < 3 && !mesh.mesh.vertices.empty(); ++axis) {
    std::vector<double> coordinates;
    coordinates.reserve(mesh.mesh.vertices.size());
    for (const Eigen::Vector3f& vertex : mesh.mesh.vertices) {
      coordinates.push_back(vertex[axis]);
    }
    middle[axis] = Median(&coordinates);
  }
  return middle;
}

OrbitCamera FirstCamera(const ShownMesh& mesh, int width, int height) {
  const View view =
      mesh.mesh.facets.empty()
          ? AutomaticView(mesh.mesh.vertices, mesh.front, width, height)
          : AutomaticView(mesh.mesh, width, height);
  return {view, Middle(mesh)};
}

Eigen::Vector3d Upwards(const std::vector<View>& cameras, const View& view) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const View& camera : cameras) {
    sum -= camera.cam_from_world_rotation.row(1).transpose();
  }
  // Cameras all around have no common one. A choice.
  constexpr double kMinMean = 0.3;
  if (sum.norm() > kMinMean * static_cast<double>(cameras.size())) {
    return sum.normalized();
  }
  return -view.cam_from_world_rotation.row(1).transpose();
}

}  // namespace colmap_ext
