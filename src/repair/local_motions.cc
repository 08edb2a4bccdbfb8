#include "repair/local_motions.h"

#include <algorithm>
#include <cstddef>

#include "mesh/facet_normals.h"

namespace colmap_ext {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

// Positions of some vertices that change, of the others those of the mesh.
class Positions {
 public:
  Positions(const TriangleMesh& mesh, const std::vector<uint32_t>& vertices)
      : mesh_(mesh), vertices_(vertices) {
    for (const uint32_t vertex : vertices) {
      values_.push_back(mesh.vertices[vertex].cast<double>());
    }
  }

  Vector3d operator[](uint32_t vertex) const {
    const auto place =
        std::lower_bound(vertices_.begin(), vertices_.end(), vertex);
    return place != vertices_.end() && *place == vertex
               ? values_[place - vertices_.begin()]
               : mesh_.vertices[vertex].cast<double>();
  }

  void Set(std::vector<Vector3d> values) { values_ = std::move(values); }

  VertexTargets Targets() const {
    VertexTargets targets{vertices_, {}};
    for (const Vector3d& value : values_) {
      targets.positions.emplace_back(value.cast<float>());
    }
    return targets;
  }

 private:
  const TriangleMesh& mesh_;
  const std::vector<uint32_t>& vertices_;  // ascending
  std::vector<Vector3d> values_;           // of these
};

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
  std::vector<std::vector<uint32_t>> drawing;
  for (const uint32_t vertex : vertices) {
    drawing.push_back(Drawing(mesh, rings, vertex));
  }
  Positions positions(mesh, vertices);
  for (int round = 0; round < num_rounds; ++round) {
    std::vector<Vector3d> next;
    for (size_t i = 0; i < vertices.size(); ++i) {
      const Vector3d position = positions[vertices[i]];
      Vector3d sum = Vector3d::Zero();
      for (const uint32_t neighbor : drawing[i]) {
        sum += positions[neighbor];
      }
      next.push_back(
          drawing[i].empty()
              ? position
              : Vector3d(0.5 * (position + sum / drawing[i].size())));
    }
    positions.Set(std::move(next));
  }
  return positions.Targets();
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
