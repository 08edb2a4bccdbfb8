#pragma once

#include <array>
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

// Of new vertices that lie in the middle between two old ones, or are old ones
// (both the same): mean colours, and the views of either.
// \param sources [V] two old vertices each
VertexAttributes InterpolateAttributes(
    const VertexAttributes& attributes,
    const std::vector<std::array<uint32_t, 2>>& sources);

}  // namespace colmap_ext
