#pragma once

#include <functional>
#include <vector>

#include <Eigen/Geometry>

#include "mesh/triangle_mesh.h"

namespace colmap_ext::synthetic {

// A solid as the set of points where a function is negative: a coarse shape
// whose value is close to the signed distance, and detail that is added to it.
struct Solid {
  Eigen::AlignedBox3f box;  // that is meshed, world frame, scene units
  std::function<float(const Eigen::Vector3f&)> shape;
  std::function<float(const Eigen::Vector3f&)> detail;
  float max_detail = 0;  // bound of |detail|, scene units

  float operator()(const Eigen::Vector3f& point) const {
    return shape(point) + detail(point);
  }
};

// The surface of the solid inside of its box: marching tetrahedra on a lattice
// of cubes cut in six (Kuhn), which gives a manifold for any function; then
// vertices are spread along the surface. Facets are oriented to the outside.
// The mesh ends where the box cuts the solid. \param cell_size edge of a cube,
// scene units \pre the shape's gradient is nowhere longer than 1.5
TriangleMesh MeshSolid(const Solid& solid, float cell_size);

// Unit normals at the vertices, means of the facets' weighted by area.
std::vector<Eigen::Vector3f> VertexNormals(const TriangleMesh& mesh);

}  // namespace colmap_ext::synthetic
