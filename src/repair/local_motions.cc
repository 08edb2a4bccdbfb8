#include "repair/local_motions.h"

#include <algorithm>
#include <cstddef>
#include <unordered_map>
#include <utility>

#include "base/rows.h"
#include "mesh/facet_normals.h"

namespace colmap_ext {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

// Whether an edge has one facet.
bool IsBorderEdge(const TriangleMesh& mesh, const VertexRings& rings,
                  uint32_t from, uint32_t to) {
  const auto corners = rings.corners[from];
  return std::count_if(corners.begin(), corners.end(), [&](uint32_t corner) {
           const Facet& facet = mesh.facets[corner / 3];
           return std::find(facet.begin(), facet.end(), to) != facet.end();
         }) == 1;
}

// Those that a vertex is drawn to.
std::vector<uint32_t> Drawing(const TriangleMesh& mesh,
                              const VertexRings& rings, uint32_t vertex) {
  std::vector<uint32_t> neighbors;
  for (const uint32_t neighbor : rings.neighbors[vertex]) {
    if (rings.is_border[vertex] == 0 ||
        IsBorderEdge(mesh, rings, vertex, neighbor)) {
      neighbors.push_back(neighbor);
    }
  }
  if (rings.is_border[vertex] != 0 && neighbors.size() != 2) {
    neighbors.clear();
  }
  return neighbors;
}

}  // namespace

VertexTargets Smoothed(const TriangleMesh& mesh, const VertexRings& rings,
                       const std::vector<uint32_t>& vertices, int num_rounds) {
  // The vertices first, then those that stay and draw them.
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
    for (const uint32_t neighbor : Drawing(mesh, rings, vertex)) {
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

VertexTargets Pushed(const TriangleMesh& mesh, const VertexRings& rings,
                     const std::vector<uint32_t>& vertices, double share) {
  VertexTargets targets{vertices, {}};
  for (const uint32_t vertex : vertices) {
    const Vector3f& position = mesh.vertices[vertex];
    Vector3f normal = Vector3f::Zero();
    for (const uint32_t corner : rings.corners[vertex]) {
      normal += FacetNormal(mesh, corner / 3);
    }
    float length = 0;
    const auto ring = rings.neighbors[vertex];
    for (const uint32_t neighbor : ring) {
      length += (mesh.vertices[neighbor] - position).norm();
    }
    length /= std::max<float>(1, static_cast<float>(ring.size()));
    targets.positions.emplace_back(position + static_cast<float>(share) *
                                                  length * normal.normalized());
  }
  return targets;
}

}  // namespace colmap_ext
