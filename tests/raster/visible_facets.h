#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "raster/facet_id_buffer.h"
#include "raster/visibility_buffers.h"
#include "spatial/bvh.h"

namespace colmap_ext {

inline FacetVisibility VisibleFacets(const TriangleMesh& mesh,
                                     const std::vector<View>& views,
                                     double min_cosine = 0.1) {
  return FindVisibleFacets(
      VisibilityBuffers(mesh, views, min_cosine, SIZE_MAX));
}

struct DepthRange {
  double nearest;
  double farthest;
};

// Of what rays meet first at the corners of a square around a place of an
// image, `reach` pixels to each side.
inline DepthRange DepthsAround(const Bvh& mesh, const View& view,
                               const Eigen::Vector2d& pixel, double reach = 1) {
  RayPacket rays;
  rays.origin = view.Center().cast<float>();
  for (int i = 0; i < 4; ++i) {
    rays.SetDirection(
        i, RayDirection(view, pixel.x() + (i % 2 == 0 ? -reach : reach),
                        pixel.y() + (i / 2 == 0 ? -reach : reach)));
  }
  const HitPacket hits = mesh.Intersect(rays);
  const auto [nearest, farthest] = std::minmax(
      {hits.distance[0], hits.distance[1], hits.distance[2], hits.distance[3]});
  return {nearest, farthest};
}

// Of a point's projection onto the plane of a facet; they add up to 1.
inline Eigen::Vector3d Barycentric(const FacetFrame& frame,
                                   const Eigen::Vector3d& point) {
  const Eigen::Vector3d from_corner = point - frame.corner;
  const double second = frame.gradient_1.dot(from_corner);
  const double third = frame.gradient_2.dot(from_corner);
  return {1 - second - third, second, third};
}

}  // namespace colmap_ext
