#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace colmap_ext {

using Facet = std::array<uint32_t, 3>;  // vertex indices, counter-clockwise
                                        // seen from free space

// In place of the old vertex or facet that a new one comes from: none.
inline constexpr uint32_t kNoSource = UINT32_MAX;

// An indexed triangle mesh, nothing but its two arrays. What belongs to the
// vertices (colours, views) travels in arrays of the same length beside it.
struct TriangleMesh {
  std::vector<Eigen::Vector3f> vertices;  // [V], world frame, scene units
  std::vector<Facet> facets;              // [F]
};

}  // namespace colmap_ext
