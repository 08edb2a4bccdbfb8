#include "repair/guarded_mesh.h"

#include <algorithm>
#include <unordered_map>
#include <utility>

#include "base/rows.h"
#include "mesh/normals.h"

namespace colmap_ext {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

// Those that a vertex is drawn to.
std::vector<uint32_t> Drawing(const TriangleMesh& mesh,
                              const VertexRings& rings, uint32_t vertex) {
  std::vector<uint32_t> neighbors = SmoothingNeighbors(mesh, rings, vertex);
  if (rings.is_border[vertex] != 0 && neighbors.size() != 2) {
    neighbors.clear();
  }
  return neighbors;
}

// Of the mean of the facets' normals at a vertex.
Vector3f NormalAt(const GuardedMesh& mesh, uint32_t vertex) {
  Vector3f normal = Vector3f::Zero();
  for (const uint32_t corner : mesh.rings().corners[vertex]) {
    normal += FacetNormal(mesh.mesh(), corner / 3);
  }
  return normal.normalized();
}

}  // namespace

VertexTargets Smoothed(const GuardedMesh& guarded,
                       const std::vector<uint32_t>& vertices, int num_rounds) {
  const TriangleMesh& mesh = guarded.mesh();
  // The vertices first, then their neighbors that do not move.
  std::vector<Vector3d> positions;
  std::unordered_map<uint32_t, uint32_t> places;
  const auto place_of = [&](uint32_t vertex) {
    const auto [place, is_new] = places.try_emplace(vertex, positions.size());
    if (is_new) {
      positions.push_back(mesh.vertices[vertex].cast<double>());
    }
    return place->second;
  };
  for (const uint32_t vertex : vertices) {
    place_of(vertex);
  }
  Rows<uint32_t> drawing;
  for (const uint32_t vertex : vertices) {
    for (const uint32_t neighbor : Drawing(mesh, guarded.rings(), vertex)) {
      drawing.values.push_back(place_of(neighbor));
    }
    drawing.EndRow();
  }
  std::vector<Vector3d> next = positions;
  for (int round = 0; round < num_rounds; ++round) {
    for (size_t i = 0; i < vertices.size(); ++i) {
      const auto row = drawing[i];
      Vector3d sum = Vector3d::Zero();
      for (const uint32_t neighbor : row) {
        sum += positions[neighbor];
      }
      if (!row.empty()) {
        next[i] = 0.5 * (positions[i] + sum / static_cast<double>(row.size()));
      }
    }
    std::swap(positions, next);
  }
  VertexTargets targets{vertices, {}};
  for (size_t i = 0; i < vertices.size(); ++i) {
    targets.positions.emplace_back(positions[i].cast<float>());
  }
  return targets;
}

VertexTargets Pushed(const GuardedMesh& mesh,
                     const std::vector<uint32_t>& vertices, double share) {
  VertexTargets targets{vertices, {}};
  for (const uint32_t vertex : vertices) {
    const Vector3f& position = mesh.mesh().vertices[vertex];
    float length = 0;
    const auto ring = mesh.rings().neighbors[vertex];
    for (const uint32_t neighbor : ring) {
      length += (mesh.mesh().vertices[neighbor] - position).norm();
    }
    length /= std::max<float>(1, static_cast<float>(ring.size()));
    targets.positions.emplace_back(
        position + static_cast<float>(share) * length * NormalAt(mesh, vertex));
  }
  return targets;
}

}  // namespace colmap_ext
