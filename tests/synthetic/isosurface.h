#pragma once

#include <functional>

#include <Eigen/Geometry>

#include "mesh/triangle_mesh.h"

namespace colmap_ext::synthetic {

// A solid as the set of points where a function is negative: a coarse shape
// whose value is close to the signed distance, and detail that is added to it.
struct Solid {
  Eigen::AlignedBox3f box;  // what is of interest, world frame, scene units
  std::function<float(const Eigen::Vector3f&)> shape;
  std::function<float(const Eigen::Vector3f&)> detail;
  float max_detail = 0;  // bound of |detail|, scene units

  float operator()(const Eigen::Vector3f& point) const {
    return shape(point) + detail(point);
  }
};

// The surface of the solid inside of its box: marching tetrahedra on a lattice
// of cubes cut in six (Kuhn), which gives a manifold whatever the function is,
// then vertices spread along the surface and put back onto it. Facets are
// oriented to the outside. Where the box cuts the solid the mesh ends.
// \param cell_size edge of a cube, scene units
// \pre the shape's gradient is nowhere longer than 1.5
TriangleMesh MeshSolid(const Solid& solid, float cell_size, int num_threads);

}  // namespace colmap_ext::synthetic
