#pragma once

#include <cstddef>
#include <vector>

#include <tbb/parallel_for.h>
#include <Eigen/Geometry>

#include "mesh/triangle_mesh.h"

namespace colmap_ext {

// A facet's plane and the barycentric coordinates on it, in the world frame.
struct FacetFrame {
  Eigen::Vector3d normal;      // unit, towards free space; 0: degenerate
  Eigen::Vector3d corner;      // the first, scene units
  Eigen::Vector3d gradient_1;  // of the second corner's barycentric coordinate,
                               // 1 / scene unit
  Eigen::Vector3d gradient_2;  // of the third's
};

inline FacetFrame ComputeFacetFrame(const TriangleMesh& mesh,
                                    const Facet& facet) {
  const auto [a, b, c] = CornersOf<double>(mesh, facet);
  const Eigen::Vector3d edge_1 = b - a;
  const Eigen::Vector3d edge_2 = c - a;
  const Eigen::Vector3d cross = edge_1.cross(edge_2);
  const double area = cross.norm();  // twice
  if (!(area > 0)) {
    const Eigen::Vector3d zero = Eigen::Vector3d::Zero();
    return {zero, a, zero, zero};
  }
  const Eigen::Vector3d normal = cross / area;
  return {normal, a, edge_2.cross(normal) / area, normal.cross(edge_1) / area};
}

// [F] of all facets.
inline std::vector<FacetFrame> ComputeFacetFrames(const TriangleMesh& mesh) {
  std::vector<FacetFrame> frames(mesh.facets.size());
  tbb::parallel_for(size_t{0}, frames.size(), [&](size_t i) {
    frames[i] = ComputeFacetFrame(mesh, mesh.facets[i]);
  });
  return frames;
}

}  // namespace colmap_ext
