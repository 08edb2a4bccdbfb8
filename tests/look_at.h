#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "mesh/triangle_mesh.h"
#include "scene/view.h"

namespace colmap_ext {

// A camera at `eye` that looks at `target`, the y axis downwards in its image.
inline View LookAt(const Eigen::Vector3d& eye, const Eigen::Vector3d& target,
                   int width, int height, double focal_length) {
  return LookAtView(eye, target, -Eigen::Vector3d::UnitY(), width, height,
                    focal_length);
}

// The views of a scene that is scaled around the origin.
inline std::vector<View> Scaled(std::vector<View> views, double factor) {
  for (View& view : views) {
    view.cam_from_world_translation *= factor;
  }
  return views;
}

// The inverse depth at which the ray through a pixel meets a facet; 0: nowhere.
inline double InverseDepthAt(const View& view, const TriangleMesh& mesh,
                             uint32_t facet, const Eigen::Vector2d& pixel) {
  const auto [a, b, c] = CornersOf<double>(mesh, mesh.facets[facet]);
  Eigen::Matrix3d matrix;
  matrix << b - a, c - a, -(view.RayFromPixel() * pixel.homogeneous());
  const Eigen::Vector3d x = matrix.inverse() * (view.Center() - a);
  const bool is_met = x[0] >= 0 && x[1] >= 0 && x[0] + x[1] <= 1 && x[2] > 0;
  return is_met ? 1 / x[2] : 0;
}

}  // namespace colmap_ext
