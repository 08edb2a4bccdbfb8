#include "meshing/point_support.h"

namespace colmap_ext {

std::vector<float> SupportOfVertices(
    size_t num_vertices, const std::vector<uint32_t>& point_vertices,
    const std::vector<float>& point_weights) {
  std::vector<float> supports(num_vertices, 0);
  for (size_t point = 0; point < point_vertices.size(); ++point) {
    supports[point_vertices[point]] += point_weights[point];
  }
  return supports;
}

std::vector<float> SupportOfSurface(
    const std::vector<float>& supports,
    const std::vector<std::array<uint32_t, 2>>& sources) {
  const auto support = [&](uint32_t vertex) {
    return vertex < supports.size() ? supports[vertex] : 0.0f;
  };
  std::vector<float> of_surface;
  of_surface.reserve(sources.size());
  for (const auto& [a, b] : sources) {
    of_surface.push_back((support(a) + support(b)) / 2);
  }
  return of_surface;
}

}  // namespace colmap_ext
