#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "base/index_limit.h"

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

}  // namespace colmap_ext
