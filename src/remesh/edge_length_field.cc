#include "remesh/edge_length_field.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

#include <tbb/parallel_for.h>

#include "mesh/adjacency.h"
#include "mesh/normals.h"

namespace colmap_ext {

std::vector<float> MeanEdgeLengths(const TriangleMesh& mesh) {
  // So that a vertex's own facets decide less than the surface around it.
  constexpr int kSmoothings = 3;
  const VertexRings rings = MakeVertexRings(mesh);
  std::vector<float> lengths(mesh.vertices.size(), 0);
  const auto mean_around = [&](size_t vertex, const auto& value) {
    float sum = 0;
    for (const uint32_t neighbor : rings.neighbors[vertex]) {
      sum += value(neighbor);
    }
    const auto count = static_cast<float>(rings.neighbors[vertex].size());
    return count > 0 ? sum / count : 0;
  };
  for (size_t i = 0; i < lengths.size(); ++i) {
    lengths[i] = mean_around(i, [&](uint32_t neighbor) {
      return (mesh.vertices[neighbor] - mesh.vertices[i]).norm();
    });
  }
  for (int k = 0; k < kSmoothings; ++k) {
    const std::vector<float> before = lengths;
    for (size_t i = 0; i < lengths.size(); ++i) {
      lengths[i] = (before[i] + mean_around(i,
                                            [&](uint32_t neighbor) {
                                              return before[neighbor];
                                            })) /
                   2;
    }
  }
  return lengths;
}

std::vector<float> LengthsForCurvature(const TriangleMesh& mesh,
                                       const std::vector<float>& tolerances) {
  const VertexRings rings = MakeVertexRings(mesh);
  const std::vector<Eigen::Vector3f> normals = VertexNormals(mesh, rings);
  std::vector<float> lengths(mesh.vertices.size());
  tbb::parallel_for(size_t{0}, lengths.size(), [&](size_t i) {
    float curvature = 0;
    for (const uint32_t neighbor : rings.neighbors[i]) {
      const float length = (mesh.vertices[neighbor] - mesh.vertices[i]).norm();
      if (length > 0) {
        curvature = std::max(curvature,
                             (normals[neighbor] - normals[i]).norm() / length);
      }
    }
    const float tolerance = tolerances[i];
    const bool is_bounded = curvature > 0 && std::isfinite(tolerance);
    lengths[i] =
        is_bounded
            ? std::sqrt(std::max(
                  6 * tolerance / curvature - 3 * tolerance * tolerance, 0.0F))
            : std::numeric_limits<float>::infinity();
  });
  return lengths;
}

void LimitGradation(const TriangleMesh& mesh, float gradation,
                    std::vector<float>* lengths) {
  const VertexRings rings = MakeVertexRings(mesh);
  // Dijkstra's algorithm from all vertices at once.
  using Entry = std::pair<float, uint32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  for (uint32_t i = 0; i < lengths->size(); ++i) {
    queue.emplace((*lengths)[i], i);
  }
  while (!queue.empty()) {
    const auto [length, vertex] = queue.top();
    queue.pop();
    if (length > (*lengths)[vertex]) {
      continue;
    }
    for (const uint32_t neighbor : rings.neighbors[vertex]) {
      const float limit =
          length +
          gradation * (mesh.vertices[neighbor] - mesh.vertices[vertex]).norm();
      if (limit < (*lengths)[neighbor]) {
        (*lengths)[neighbor] = limit;
        queue.emplace(limit, neighbor);
      }
    }
  }
}

std::vector<float> TolerancesOf(std::vector<float> lengths) {
  constexpr float kShare = 0.1F;
  for (float& length : lengths) {
    length *= kShare;
  }
  return lengths;
}

}  // namespace colmap_ext
