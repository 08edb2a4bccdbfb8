#pragma once

#include <algorithm>

#include <Eigen/Core>

#include "scene/view.h"
#include "spatial/bvh.h"

namespace colmap_ext {

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

}  // namespace colmap_ext
