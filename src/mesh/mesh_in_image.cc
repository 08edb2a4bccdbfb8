#include "mesh/mesh_in_image.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "base/percentile.h"

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

// Twice the signed area of a triangle in the image, px^2.
double TwiceArea(const View& view, const Eigen::Vector3d& a,
                 const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const Eigen::Vector2d corner = view.ImageFromCam(a);
  const Eigen::Vector2d ab = view.ImageFromCam(b) - corner;
  const Eigen::Vector2d ac = view.ImageFromCam(c) - corner;
  return ab.x() * ac.y() - ab.y() * ac.x();
}

// Appends what a pixel covers at a point, in each view that it lies before.
void AppendFootprints(const Eigen::Vector3f& point,
                      std::span<const uint32_t> view_indices,
                      const std::vector<View>& views,
                      std::vector<double>* footprints) {
  for (const uint32_t index : view_indices) {
    const View& view = views[index];
    const double depth = view.CamFromWorld(point.cast<double>()).z();
    if (depth > 0) {
      footprints->push_back(depth / std::sqrt(view.fx * view.fy));
    }
  }
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

double NearestFootprint(const Eigen::Vector3f& point,
                        std::span<const uint32_t> view_indices,
                        const std::vector<View>& views) {
  double footprint = std::numeric_limits<double>::infinity();
  for (const uint32_t index : view_indices) {
    const View& view = views[index];
    const double depth = view.CamFromWorld(point.cast<double>()).z();
    if (depth > 0) {
      footprint = std::min(footprint, depth / std::max(view.fx, view.fy));
    }
  }
  return footprint;
}

std::vector<float> Footprints(const TriangleMesh& mesh,
                              const Rows<uint32_t>& vertex_views,
                              const std::vector<View>& views) {
  const double median = MedianFootprint(mesh, vertex_views, views);
  std::vector<float> footprints;
  footprints.reserve(mesh.vertices.size());
  std::vector<double> of_views;
  for (size_t i = 0; i < mesh.vertices.size(); ++i) {
    of_views.clear();
    AppendFootprints(mesh.vertices[i], vertex_views[i], views, &of_views);
    footprints.push_back(
        static_cast<float>(of_views.empty() ? median : Median(&of_views)));
  }
  return footprints;
}

double MedianFootprint(const TriangleMesh& mesh,
                       const Rows<uint32_t>& vertex_views,
                       const std::vector<View>& views) {
  std::vector<double> footprints;
  for (size_t i = 0; i < mesh.vertices.size(); ++i) {
    AppendFootprints(mesh.vertices[i], vertex_views[i], views, &footprints);
  }
  return footprints.empty() ? 0 : Median(&footprints);
}

bool IsFacing(const TriangleMesh& mesh, const Facet& facet,
              const Eigen::Vector3d& camera, double min_cosine) {
  const auto [a, b, c] = CornersOf<double>(mesh, facet);
  const Eigen::Vector3d cross = (b - a).cross(c - a);
  const Eigen::Vector3d to_camera = camera - (a + b + c) / 3;
  const double product = cross.dot(to_camera);
  const double scale = cross.squaredNorm() * to_camera.squaredNorm();
  return product > 0 && product * product > min_cosine * min_cosine * scale;
}

Eigen::Vector3d InverseDepthByPixel(const View& view, const TriangleMesh& mesh,
                                    const Facet& facet) {
  const auto [a, b, c] = CornersOf<double>(mesh, facet);
  const Eigen::Vector3d normal =
      view.cam_from_world_rotation * (b - a).cross(c - a);
  const double u = normal.x() / view.fx;
  const double v = normal.y() / view.fy;
  return Eigen::Vector3d(u, v, normal.z() - u * view.cx - v * view.cy) /
         normal.dot(view.CamFromWorld(a));
}

double PlaneSlope(const View& view, const TriangleMesh& mesh,
                  const Facet& facet) {
  const Eigen::Vector3d by_pixel = InverseDepthByPixel(view, mesh, facet);
  return std::abs(by_pixel.x()) + std::abs(by_pixel.y());
}

}  // namespace colmap_ext
