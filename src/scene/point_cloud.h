#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace colmap_ext {

using Color = std::array<uint8_t, 3>;  // red, green, blue

// Fused points and the views that see them: one row of `view_indices` a point
// (compressed sparse rows).
struct PointCloud {
  std::vector<Eigen::Vector3f> positions;  // [P], world frame, scene units
  std::vector<Color> colors;               // [P] or empty
  std::vector<uint64_t> view_offsets{0};   // [P + 1], into view_indices
  std::vector<uint32_t> view_indices;      // index into the views, ascending
                                           // and without repeats in each row

  size_t size() const { return positions.size(); }

  std::span<const uint32_t> Views(size_t point) const {
    return {view_indices.data() + view_offsets[point],
            view_indices.data() + view_offsets[point + 1]};
  }
};

}  // namespace colmap_ext
