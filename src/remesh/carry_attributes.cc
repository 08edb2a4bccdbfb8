#include "remesh/carry_attributes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace colmap_ext {

VertexAttributes CarryAttributes(const TriangleMesh& mesh,
                                 const VertexAttributes& attributes,
                                 const std::vector<SurfacePoint>& points) {
  VertexAttributes carried;
  for (const SurfacePoint& point : points) {
    const Facet& facet = mesh.facets[point.facet];
    std::vector<uint32_t> views;
    Eigen::Vector3f color = Eigen::Vector3f::Zero();
    for (int k = 0; k < 3; ++k) {
      if (!(point.weights[k] > 0)) {
        continue;
      }
      const auto corner_views = attributes.views[facet[k]];
      views.insert(views.end(), corner_views.begin(), corner_views.end());
      for (int c = 0; c < 3 && !attributes.colors.empty(); ++c) {
        color[c] += point.weights[k] *
                    static_cast<float>(attributes.colors[facet[k]][c]);
      }
    }
    std::sort(views.begin(), views.end());
    views.erase(std::unique(views.begin(), views.end()), views.end());
    carried.views.AddRow(views);
    if (!attributes.colors.empty()) {
      Color& rounded = carried.colors.emplace_back();
      for (int c = 0; c < 3; ++c) {
        rounded[c] =
            static_cast<uint8_t>(std::clamp(std::lround(color[c]), 0L, 255L));
      }
    }
  }
  return carried;
}

}  // namespace colmap_ext
