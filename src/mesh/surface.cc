#include "mesh/surface.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <utility>

#include <tbb/parallel_for.h>

#include "mesh/adjacency.h"
#include "scene/point_tree.h"

namespace colmap_ext {
namespace {

// Both are choices: around a vertex there are several points, and not all of
// them have all views.
constexpr size_t kNumNearest = 4;  // points
constexpr double kReach = 3;       // mean lengths of the vertex's edges

}  // namespace

Provenance IdentityOf(const TriangleMesh& mesh) {
  Provenance identity;
  for (uint32_t i = 0; i < mesh.vertices.size(); ++i) {
    identity.vertices.push_back({i, i});
  }
  identity.facets = Iota(mesh.facets.size());
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
  part.mesh.facets.resize(part.facets.size());
  tbb::parallel_for(size_t{0}, part.facets.size(), [&](size_t i) {
    for (size_t k = 0; k < 3; ++k) {
      part.mesh.facets[i][k] =
          IndexOf(part.vertices, mesh.facets[part.facets[i]][k]);
    }
  });
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

void AddAttributes(const VertexAttributes& from, size_t vertex,
                   VertexAttributes* to) {
  if (from.views.size() > 0) {
    to->views.AddRow(from.views[vertex]);
  }
  AppendIfAny(from.colors, vertex, &to->colors);
  AppendIfAny(from.confidences, vertex, &to->confidences);
}

VertexAttributes InterpolateAttributes(
    const VertexAttributes& attributes,
    const std::vector<std::array<uint32_t, 2>>& sources) {
  VertexAttributes interpolated;
  interpolated.views = MakeRows<uint32_t>(
      sources.size(), [&](size_t i, std::vector<uint32_t>* views) {
        const auto& [a, b] = sources[i];
        std::ranges::set_union(attributes.views[a], attributes.views[b],
                               std::back_inserter(*views));
      });
  for (const auto& [a, b] : sources) {
    if (!attributes.colors.empty()) {
      Color color;
      for (int k = 0; k < 3; ++k) {
        color[k] = static_cast<uint8_t>(
            (attributes.colors[a][k] + attributes.colors[b][k] + 1) / 2);
      }
      interpolated.colors.push_back(color);
    }
    if (!attributes.confidences.empty()) {
      interpolated.confidences.push_back(
          (attributes.confidences[a] + attributes.confidences[b]) / 2);
    }
  }
  return interpolated;
}

VertexAttributes NearestAttributes(const TriangleMesh& mesh,
                                   const PointCloud& points) {
  const PointTree tree(points.positions);
  const std::vector<double> lengths =
      MeanLengths(MakeVertexRings(mesh).neighbors, mesh.vertices);
  const size_t num_vertices = mesh.vertices.size();
  VertexAttributes attributes;
  attributes.colors.resize(points.colors.empty() ? 0 : num_vertices);
  const auto append = [&](size_t i, std::vector<uint32_t>* all) {
    const Eigen::Vector3f& vertex = mesh.vertices[i];
    std::vector<uint32_t> views;
    for (const uint32_t point :
         tree.Nearest(vertex, kNumNearest, kReach * lengths[i])) {
      Append(points.views[point], &views);
    }
    SortUnique(&views);
    Append(views, all);
    if (!points.colors.empty()) {
      constexpr float kAnywhere = std::numeric_limits<float>::infinity();
      attributes.colors[i] =
          points.colors[tree.Nearest(vertex, 1, kAnywhere)[0]];
    }
  };
  attributes.views = MakeRows<uint32_t>(num_vertices, append);
  return attributes;
}

}  // namespace colmap_ext
