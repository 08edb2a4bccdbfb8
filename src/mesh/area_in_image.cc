#include "mesh/area_in_image.h"

#include <array>
#include <cmath>

namespace colmap_ext {

double AreaInImage(const TriangleMesh& mesh, const Facet& facet,
                   const View& view) {
  std::array<Eigen::Vector2d, 3> corners;
  for (int k = 0; k < 3; ++k) {
    corners[k] = view.ImageFromCam(
        view.CamFromWorld(mesh.vertices[facet[k]].cast<double>()));
  }
  const Eigen::Vector2d a = corners[1] - corners[0];
  const Eigen::Vector2d b = corners[2] - corners[0];
  return std::abs(a.x() * b.y() - a.y() * b.x()) / 2;
}

}  // namespace colmap_ext
