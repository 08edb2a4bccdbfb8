#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "mesh/triangle_mesh.h"
#include "raster/facet_id_buffer.h"
#include "raster/visibility_buffers.h"
#include "scene/images.h"
#include "spatial/bvh.h"
#include "tests/look_at.h"
#include "tests/raster/pixels.h"

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

// A room of 8 x 3 x 6 around the origin, seen from inside: two facets a wall.
inline TriangleMesh MakeRoom() {
  TriangleMesh room;
  for (int i = 0; i < 8; ++i) {
    room.vertices.emplace_back((i & 1) != 0 ? 4.F : -4.F,
                               (i & 2) != 0 ? 1.5F : -1.5F,
                               (i & 4) != 0 ? 3.F : -3.F);
  }
  for (uint32_t axis = 0; axis < 3; ++axis) {
    const uint32_t a = 1U << (axis + 1) % 3;
    const uint32_t b = 1U << (axis + 2) % 3;
    const uint32_t far = 1U << axis;
    room.facets.push_back({0, a, a + b});
    room.facets.push_back({0, a + b, b});
    room.facets.push_back({far, far + a + b, far + a});
    room.facets.push_back({far, far + b, far + a + b});
  }
  return room;
}

// Cameras in it, some of them near a wall.
inline std::vector<View> RoomViews() {
  return {LookAt({0.3, 0.2, 0.1}, {4, 0.3, 2.5}, 64, 48, 40),
          LookAt({-0.4, 0.3, -0.2}, {4, 0.1, 2}, 64, 48, 40),
          LookAt({3.9, 1.2, -2.8}, {-4, -1, 2.9}, 60, 50, 30),
          LookAt({-1, 0.7, 0.5}, {-0.5, -0.9, 2}, 48, 64, 70),
          LookAt({1, 1.45, 0}, {-4, 1.3, 0.4}, 64, 48, 50)};
}

// What a view shows of a mesh that is painted, and 0 beside it.
// \param paint  the grey value at a point of the world
template <typename Paint>
GrayImage PaintedImage(const View& view, const TriangleMesh& mesh,
                       const Paint& paint) {
  const DrawnFacets drawn = DrawFacets(view, mesh, 0);
  GrayImage image{view.width, view.height, {}};
  ForEachPixel(view, [&](int row, int col) {
    const double inverse_depth = drawn.inverse_depths[drawn.Index(row, col)];
    const Eigen::Vector3d ray =
        view.RayFromPixel() * Eigen::Vector3d(col + 0.5, row + 0.5, 1);
    const double gray =
        inverse_depth > 0 ? paint(view.Center() + ray / inverse_depth) : 0;
    image.pixels.push_back(static_cast<uint8_t>(gray));
  });
  return image;
}

// What a camera in the room sees of its walls, which are painted.
inline GrayImage RoomImage(const View& view) {
  return PaintedImage(view, MakeRoom(), [](const Eigen::Vector3d& p) {
    return 128 +
           40 * (std::sin(3 * p.x() + 2 * p.y()) + std::sin(4 * p.y() - p.z()) +
                 std::sin(3 * p.z() + p.x()));
  });
}

// [F] of all facets.
inline std::vector<FacetFrame> ComputeFacetFrames(const TriangleMesh& mesh) {
  std::vector<FacetFrame> frames;
  for (const Facet& facet : mesh.facets) {
    frames.push_back(ComputeFacetFrame(mesh, facet));
  }
  return frames;
}

}  // namespace colmap_ext
