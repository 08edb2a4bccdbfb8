#include "mesh/clip_to_image.h"

#include <algorithm>
#include <cstddef>

namespace colmap_ext {

namespace {

using Polygon = std::vector<Eigen::Vector3d>;

// The part of a polygon with normal . point >= 0.
Polygon CutOff(const Polygon& polygon, const Eigen::Vector3d& normal) {
  Polygon part;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector3d& from = polygon[i];
    const Eigen::Vector3d& to = polygon[(i + 1) % polygon.size()];
    const double from_side = normal.dot(from);
    const double to_side = normal.dot(to);
    if (from_side >= 0) {
      part.push_back(from);
    }
    if ((from_side >= 0) != (to_side >= 0)) {
      // From inside to outside, whichever way the edge is run.
      part.push_back(from_side >= 0
                         ? from +
                               from_side / (from_side - to_side) * (to - from)
                         : to + to_side / (to_side - from_side) * (from - to));
    }
  }
  return part;
}

}  // namespace

Polygon ClipToImage(const View& view, const TriangleMesh& mesh,
                    const Facet& facet, const Eigen::AlignedBox2d& box) {
  Polygon polygon;
  for (const uint32_t vertex : facet) {
    polygon.push_back(view.CamFromWorld(mesh.vertices[vertex].cast<double>()));
  }
  for (const Eigen::Vector3d& normal :
       {Eigen::Vector3d(view.fx, 0, view.cx - box.min().x()),
        Eigen::Vector3d(-view.fx, 0, box.max().x() - view.cx),
        Eigen::Vector3d(0, view.fy, view.cy - box.min().y()),
        Eigen::Vector3d(0, -view.fy, box.max().y() - view.cy)}) {
    polygon = CutOff(polygon, normal);
  }
  const bool is_before =
      std::ranges::all_of(polygon, [](const auto& p) { return p.z() > 0; });
  return polygon.size() > 2 && is_before ? polygon : Polygon();
}

Eigen::AlignedBox2d ImageBox(const View& view, double border) {
  return {Eigen::Vector2d(border, border),
          Eigen::Vector2d(view.width - border, view.height - border)};
}

}  // namespace colmap_ext
