#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/rows.h"
#include "scene/point_cloud.h"

namespace colmap_ext {

// What belongs to the vertices of a mesh.
struct VertexAttributes {
  std::vector<Color> colors;  // [V] or empty
  Rows<uint32_t> views;       // [V] indices of the views that see each vertex,
                              // ascending
};

// Of new vertices that lie in the middle between two old ones, or are old ones
// (both the same): mean colours, and the views of either.
// \param sources [V] two old vertices each
VertexAttributes InterpolateAttributes(
    const VertexAttributes& attributes,
    const std::vector<std::array<uint32_t, 2>>& sources);

}  // namespace colmap_ext
