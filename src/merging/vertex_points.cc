#include "merging/vertex_points.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace colmap_ext {

VertexPoints PointsOf(const std::vector<uint32_t>& ids,
                      uint32_t num_plan_vertices, const ReadAttributes& read) {
  const auto end = std::ranges::lower_bound(ids, num_plan_vertices);
  TileVertices vertices = read(std::vector<uint32_t>(ids.begin(), end));
  VertexPoints points;
  points.cloud.colors = std::move(vertices.colors);
  points.cloud.views = std::move(vertices.views);
  points.supports = std::move(vertices.supports);
  points.is_end = std::move(vertices.observations.is_end);
  points.vertex_points.resize(points.supports.size());
  std::iota(points.vertex_points.begin(), points.vertex_points.end(), 0);
  return points;
}

}  // namespace colmap_ext
