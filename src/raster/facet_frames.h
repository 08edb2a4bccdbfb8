#pragma once

#include <vector>

#include <Eigen/Core>

#include "mesh/triangle_mesh.h"

namespace colmap_ext {

// A facet's plane and the barycentric coordinates on it, in the world frame.
struct FacetFrame {
  Eigen::Vector3d normal;      // unit, towards free space; 0: degenerate
  Eigen::Vector3d corner;      // the first, scene units
  Eigen::Vector3d gradient_1;  // of the second corner's barycentric coordinate,
                               // 1 / scene unit
  Eigen::Vector3d gradient_2;  // of the third's

  // Of the point's projection onto the plane; they add up to 1.
  Eigen::Vector3d Barycentric(const Eigen::Vector3d& point) const {
    const Eigen::Vector3d from_corner = point - corner;
    const double second = gradient_1.dot(from_corner);
    const double third = gradient_2.dot(from_corner);
    return {1 - second - third, second, third};
  }
};

FacetFrame ComputeFacetFrame(const TriangleMesh& mesh, const Facet& facet);

// [F] of all facets.
std::vector<FacetFrame> ComputeFacetFrames(const TriangleMesh& mesh);

}  // namespace colmap_ext
