#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "base/indices.h"

namespace colmap_ext {

using Facet = std::array<uint32_t, 3>;  // vertex indices, counter-clockwise
                                        // seen from free space

inline bool RepeatsVertex(const Facet& facet) {
  return facet[0] == facet[1] || facet[1] == facet[2] || facet[2] == facet[0];
}

// An indexed triangle mesh, nothing but its two arrays. What belongs to the
// vertices (colours, views) travels in arrays of the same length beside it.
struct TriangleMesh {
  std::vector<Eigen::Vector3f> vertices;  // [V], world frame, scene units
  std::vector<Facet> facets;              // [F]

  bool operator==(const TriangleMesh&) const = default;
};

// The positions of a facet's corners.
// \pre its indices are in range
template <typename Scalar = float>
std::array<Eigen::Matrix<Scalar, 3, 1>, 3> CornersOf(const TriangleMesh& mesh,
                                                     const Facet& facet) {
  return {mesh.vertices[facet[0]].cast<Scalar>(),
          mesh.vertices[facet[1]].cast<Scalar>(),
          mesh.vertices[facet[2]].cast<Scalar>()};
}

}  // namespace colmap_ext
