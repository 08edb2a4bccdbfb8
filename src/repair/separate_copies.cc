#include "repair/separate_copies.h"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "mesh/facet_normals.h"

namespace colmap_ext {
namespace {

using Eigen::Vector3f;

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
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()),
                   vertices.end());
    if (vertices.size() > 1) {
      copies.insert(copies.end(), vertices.begin(), vertices.end());
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
  Vector3f normal = Vector3f::Zero();
  for (const uint32_t corner : mesh.rings().corners[vertex]) {
    normal += FacetNormal(mesh.mesh(), corner / 3);
  }
  const float share = 0.25F / static_cast<float>(ring.size());
  to_mean *= share;
  normal = share * length * normal.normalized();
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

// \return whether the vertex was moved
bool MoveApart(uint32_t vertex, GuardedMesh* mesh) {
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
      return mesh->Move(best);
    }
  }
  return false;
}

}  // namespace

size_t SeparateCopies(GuardedMesh* mesh, size_t max_work) {
  std::vector<uint32_t> moved;
  for (int pass = 0; pass < kMaxPasses; ++pass) {
    const size_t num_pairs = mesh->NumPairs();
    for (const uint32_t vertex : FindCopies(*mesh)) {
      if (mesh->Work() > max_work) {
        break;
      }
      if (!IsFixed(mesh->fixed(), vertex) && MoveApart(vertex, mesh)) {
        moved.push_back(vertex);
      }
    }
    if (mesh->NumPairs() == num_pairs) {
      break;
    }
  }
  std::sort(moved.begin(), moved.end());
  return std::unique(moved.begin(), moved.end()) - moved.begin();
}

}  // namespace colmap_ext
