#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "delaunay/tetrahedralization.h"

namespace colmap_ext {

// Where corners lie around a ray is told by determinants of their offsets from
// its origin across it. Each of the four factors of one is off by less than 8 e
// times the size of its corner, the sum of the absolute components (the axes by
// 4 e, the product's three terms by the rest), e = 2^-53, and so the
// determinant by less than 40 e times both sizes.
inline constexpr double kTurnErrorBound = 40 * 0x1p-53;

// From the origin of a ray to a facet that it passes through, scene units. It
// starts at the lowest corner, so that rounding depends on the ray and the
// facet alone and not on the way there.
// \param direction  of length 1
inline double FacetDistance(const Tetrahedralization& tetrahedra,
                            const std::array<uint32_t, 3>& corners,
                            const Eigen::Vector3d& origin,
                            const Eigen::Vector3d& direction) {
  const auto is_lower = [&](uint32_t u, uint32_t v) {
    const Eigen::Vector3f& p = tetrahedra.points[u];
    const Eigen::Vector3f& q = tetrahedra.points[v];
    return std::lexicographical_compare(p.begin(), p.end(), q.begin(), q.end());
  };
  const auto first = static_cast<size_t>(
      std::ranges::min_element(corners, is_lower) - corners.begin());
  const auto offset = [&](size_t i) -> Eigen::Vector3d {
    return tetrahedra.points[corners[i % 3]].cast<double>() - origin;
  };
  const Eigen::Vector3d a = offset(first);
  const Eigen::Vector3d normal =
      (offset(first + 1) - a).cross(offset(first + 2) - a);
  return a.dot(normal) / direction.dot(normal);
}

}  // namespace colmap_ext
