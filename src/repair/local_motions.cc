#include "repair/guarded_mesh.h"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <unordered_map>
#include <utility>

#include "base/indices.h"
#include "base/rows.h"
#include "mesh/normals.h"

namespace colmap_ext {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

// Whether an edge has one facet.
bool IsBorderEdge(const TriangleMesh& mesh, const VertexRings& rings,
                  uint32_t from, uint32_t to) {
  return std::ranges::count_if(rings.corners[from], [&](uint32_t corner) {
           return std::ranges::count(mesh.facets[corner / 3], to) > 0;
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

// Of the mean of the facets' normals at a vertex.
Vector3f NormalAt(const GuardedMesh& mesh, uint32_t vertex) {
  Vector3f normal = Vector3f::Zero();
  for (const uint32_t corner : mesh.rings().corners[vertex]) {
    normal += FacetNormal(mesh.mesh(), corner / 3);
  }
  return normal.normalized();
}

// A choice: what one copy leaves another may solve, once it has moved.
constexpr int kMaxPasses = 3;

// Vertices of facets that intersect, where several share a position; ascending.
std::vector<uint32_t> FindCopies(const GuardedMesh& mesh) {
  std::map<std::array<float, 3>, std::vector<uint32_t>> at_position;
  for (const FacetPair& pair : mesh.Pairs()) {
    for (const uint32_t facet : pair) {
      for (const uint32_t vertex : mesh.mesh().facets[facet]) {
        const Vector3f& p = mesh.mesh().vertices[vertex];
        at_position[{p.x(), p.y(), p.z()}].push_back(vertex);
      }
    }
  }
  std::vector<uint32_t> copies;
  for (auto& [position, vertices] : at_position) {
    SortUnique(&vertices);
    if (vertices.size() > 1) {
      Append(vertices, &copies);
    }
  }
  std::sort(copies.begin(), copies.end());
  return copies;
}

// Ways to go: a quarter of the way to the mean of the neighbors and as far to
// the other side, and as far as that along the facets' normals.
std::vector<Vector3f> Ways(const GuardedMesh& mesh, uint32_t vertex) {
  const Vector3f& position = mesh.mesh().vertices[vertex];
  const auto ring = mesh.rings().neighbors[vertex];
  Vector3f to_mean = Vector3f::Zero();
  float length = 0;
  for (const uint32_t neighbor : ring) {
    const Vector3f edge = mesh.mesh().vertices[neighbor] - position;
    to_mean += edge;
    length += edge.norm();
  }
  const float share = 0.25F / static_cast<float>(ring.size());
  to_mean *= share;
  const Vector3f normal = share * length * NormalAt(mesh, vertex);
  return {to_mean, normal, -normal, -to_mean};
}

// A power of two, as a share of a way: about a rounding of the coordinates of
// the vertex and its neighbors.
float SmallestStep(const Vector3f& position, const Vector3f& way) {
  const float rounding =
      std::numeric_limits<float>::epsilon() *
      std::max(position.cwiseAbs().maxCoeff(), 4 * way.norm());
  float step = 1;
  while (step * way.norm() > rounding) {
    step /= 2;
  }
  return 2 * step;
}

void MoveApart(uint32_t vertex, GuardedMesh* mesh) {
  size_t fewest = mesh->NumPairs();
  VertexTargets best;
  const Vector3f position = mesh->mesh().vertices[vertex];
  for (const Vector3f& way : Ways(*mesh, vertex)) {
    for (float step = SmallestStep(position, way); step <= 1; step *= 2) {
      const VertexTargets targets{{vertex}, {position + step * way}};
      const std::optional<size_t> num_pairs = mesh->PairsAfter(targets);
      if (num_pairs && *num_pairs < fewest) {
        fewest = *num_pairs;
        best = targets;
      }
    }
    if (!best.vertices.empty()) {
      mesh->Move(best);
      return;
    }
  }
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

void SeparateCopies(GuardedMesh* mesh, size_t max_work) {
  for (int pass = 0; pass < kMaxPasses; ++pass) {
    const size_t num_pairs = mesh->NumPairs();
    for (const uint32_t vertex : FindCopies(*mesh)) {
      if (mesh->Work() > max_work) {
        break;
      }
      if (!IsFixed(mesh->fixed(), vertex)) {
        MoveApart(vertex, mesh);
      }
    }
    if (mesh->NumPairs() == num_pairs) {
      break;
    }
  }
}

}  // namespace colmap_ext
