#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "base/rows.h"

namespace colmap_ext {

// Whether a point is finite, and so near the origin that the squares of its
// distances from others are finite floats.
inline bool IsMeasurable(const Eigen::Vector3f& point) {
  constexpr float kMaxCoordinate = 1e18F;
  return point.cwiseAbs().maxCoeff<Eigen::PropagateNaN>() < kMaxCoordinate;
}

using Color = std::array<uint8_t, 3>;  // red, green, blue

// Fused points and the views that see them.
struct PointCloud {
  std::vector<Eigen::Vector3f> positions;  // [P], world frame, scene units
  std::vector<Color> colors;               // [P] or empty
  Rows<uint32_t> views;  // [P] indices of the views that see each point,
                         // ascending, without repeats

  size_t size() const { return positions.size(); }
};

}  // namespace colmap_ext
