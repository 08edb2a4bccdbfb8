#include "mesh/surface.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "mesh/adjacency.h"

namespace colmap_ext {

Provenance IdentityOf(const TriangleMesh& mesh) {
  Provenance identity;
  for (uint32_t i = 0; i < mesh.vertices.size(); ++i) {
    identity.vertices.push_back({i, i});
  }
  identity.facets.resize(mesh.facets.size());
  std::iota(identity.facets.begin(), identity.facets.end(), 0);
  return identity;
}

Provenance Compose(const Provenance& first, Provenance second) {
  for (auto& [a, b] : second.vertices) {
    a = first.vertices[a][0];
    b = first.vertices[b][1];
  }
  if (first.facets.empty()) {
    second.facets = {};
  }
  for (uint32_t& facet : second.facets) {
    facet = first.facets[facet];
  }
  return second;
}

std::vector<uint32_t> DropUnusedVertices(TriangleMesh* mesh) {
  std::vector<uint32_t> numbers(mesh->vertices.size(), kNone);
  for (const Facet& facet : mesh->facets) {
    for (const uint32_t vertex : facet) {
      numbers[vertex] = 0;
    }
  }
  std::vector<uint32_t> used;
  for (uint32_t vertex = 0; vertex < numbers.size(); ++vertex) {
    if (numbers[vertex] != kNone) {
      numbers[vertex] = static_cast<uint32_t>(used.size());
      mesh->vertices[used.size()] = mesh->vertices[vertex];
      used.push_back(vertex);
    }
  }
  mesh->vertices.resize(used.size());
  for (Facet& facet : mesh->facets) {
    facet = {numbers[facet[0]], numbers[facet[1]], numbers[facet[2]]};
  }
  return used;
}

MeshPart TakePart(const TriangleMesh& mesh, std::vector<uint32_t> facets) {
  MeshPart part{{}, VerticesOf(mesh, facets), std::move(facets)};
  for (const uint32_t vertex : part.vertices) {
    part.mesh.vertices.push_back(mesh.vertices[vertex]);
  }
  for (const uint32_t i : part.facets) {
    for (uint32_t& vertex : part.mesh.facets.emplace_back(mesh.facets[i])) {
      vertex = static_cast<uint32_t>(
          std::ranges::lower_bound(part.vertices, vertex) -
          part.vertices.begin());
    }
  }
  return part;
}

void Surface::Become(DerivedMesh derived) {
  const auto& sources = derived.from.vertices;
  attributes = InterpolateAttributes(attributes, sources);
  std::vector<Eigen::Vector3f> old_origins = std::exchange(origins, {});
  FixedSources old_fixed = std::exchange(fixed_sources, {});
  for (const auto& [a, b] : sources) {
    if (!old_origins.empty()) {
      origins.emplace_back((old_origins[a] + old_origins[b]) / 2);
    }
    if (!old_fixed.empty()) {
      fixed_sources.push_back(a == b ? old_fixed[a] : kNone);
    }
  }
  mesh = std::move(derived.mesh);
}

}  // namespace colmap_ext
