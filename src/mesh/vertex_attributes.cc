#include "mesh/vertex_attributes.h"

#include <algorithm>
#include <iterator>

namespace colmap_ext {

VertexAttributes InterpolateAttributes(
    const VertexAttributes& attributes,
    const std::vector<std::array<uint32_t, 2>>& sources) {
  VertexAttributes interpolated;
  interpolated.views.offsets.reserve(sources.size() + 1);
  for (const auto& [a, b] : sources) {
    const auto views_a = attributes.views[a];
    const auto views_b = attributes.views[b];
    std::set_union(views_a.begin(), views_a.end(), views_b.begin(),
                   views_b.end(),
                   std::back_inserter(interpolated.views.values));
    interpolated.views.EndRow();
    if (!attributes.colors.empty()) {
      Color color;
      for (int k = 0; k < 3; ++k) {
        color[k] = static_cast<uint8_t>(
            (attributes.colors[a][k] + attributes.colors[b][k] + 1) / 2);
      }
      interpolated.colors.push_back(color);
    }
    if (!attributes.confidences.empty()) {
      interpolated.confidences.push_back(
          (attributes.confidences[a] + attributes.confidences[b]) / 2);
    }
  }
  return interpolated;
}

}  // namespace colmap_ext
