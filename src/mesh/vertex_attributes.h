#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "scene/point_cloud.h"

namespace colmap_ext {

// What belongs to the vertices of a mesh.
struct VertexAttributes {
  std::vector<Color> colors;              // [V] or empty
  std::vector<uint64_t> view_offsets{0};  // [V + 1], into view_indices
  std::vector<uint32_t> view_indices;     // ascending in each row

  std::span<const uint32_t> Views(size_t vertex) const {
    return {view_indices.data() + view_offsets[vertex],
            view_indices.data() + view_offsets[vertex + 1]};
  }
};

}  // namespace colmap_ext
