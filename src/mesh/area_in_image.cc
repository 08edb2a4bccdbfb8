#include "mesh/area_in_image.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "mesh/clip_to_image.h"

namespace colmap_ext {

namespace {

// Twice the signed area of a triangle in the image, px^2.
double TwiceArea(const View& view, const Eigen::Vector3d& a,
                 const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const Eigen::Vector2d corner = view.ImageFromCam(a);
  const Eigen::Vector2d ab = view.ImageFromCam(b) - corner;
  const Eigen::Vector2d ac = view.ImageFromCam(c) - corner;
  return ab.x() * ac.y() - ab.y() * ac.x();
}

}  // namespace

double AreaInImage(const TriangleMesh& mesh, const Facet& facet,
                   const View& view) {
  std::array<Eigen::Vector3d, 3> corners;
  for (int k = 0; k < 3; ++k) {
    corners[k] = view.CamFromWorld(mesh.vertices[facet[k]].cast<double>());
  }
  const auto& [a, b, c] = corners;
  if (a.z() > 0 && b.z() > 0 && c.z() > 0) {
    return std::abs(TwiceArea(view, a, b, c)) / 2;
  }
  const std::vector<Eigen::Vector3d> part =
      ClipToImage(view, mesh, facet, ImageBox(view));
  double area = 0;
  for (size_t k = 2; k < part.size(); ++k) {
    area += TwiceArea(view, part[0], part[k - 1], part[k]);
  }
  return std::abs(area) / 2;
}

}  // namespace colmap_ext
