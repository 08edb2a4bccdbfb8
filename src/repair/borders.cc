#include "repair/borders.h"

#include <array>
#include <stdexcept>
#include <utility>

#include <Eigen/Core>

#include "mesh/adjacency.h"
#include "mesh/mesh_in_image.h"
#include "mesh/normals.h"
#include "spatial/self_intersections.h"

namespace colmap_ext {
namespace {

using Eigen::Vector3f;

constexpr int kSteps = 30;  // a choice: evens out zigzags of a few facets

// A vertex that is moved, and its neighbors on the border before and after it.
using BorderVertex = std::array<uint32_t, 3>;

// A manifold mesh has no more than one border edge to a vertex and one from it.
std::vector<BorderVertex> FindBorderVertices(
    const std::vector<uint8_t>& is_moved, const TriangleMesh& mesh) {
  std::vector<uint32_t> before(mesh.vertices.size(), kNone);
  const std::vector<uint32_t> moved = Marked(is_moved);
  for (const uint32_t half : moved) {
    before[ToVertex(mesh.facets, half)] = FromVertex(mesh.facets, half);
  }
  std::vector<BorderVertex> found;
  for (const uint32_t half : moved) {
    const uint32_t vertex = FromVertex(mesh.facets, half);
    if (before[vertex] != kNone) {
      found.push_back({vertex, before[vertex], ToVertex(mesh.facets, half)});
    }
  }
  return found;
}

Vector3f NormalOf(const TriangleMesh& mesh, uint32_t facet) {
  return AreaVector(mesh, mesh.facets[facet]).normalized();
}

// A facet at one of the vertices, and its unit normal, or zero without an area.
using GuardedFacet = std::pair<uint32_t, Vector3f>;

std::vector<GuardedFacet> FindGuarded(const std::vector<BorderVertex>& border,
                                      const TriangleMesh& mesh) {
  std::vector<uint8_t> is_border(mesh.vertices.size(), 0);
  for (const BorderVertex& vertex : border) {
    is_border[vertex[0]] = 1;
  }
  std::vector<GuardedFacet> guarded;
  for (uint32_t i = 0; i < mesh.facets.size(); ++i) {
    const auto& [a, b, c] = mesh.facets[i];
    if (is_border[a] + is_border[b] + is_border[c] > 0) {
      guarded.push_back({i, NormalOf(mesh, i)});
    }
  }
  return guarded;
}

// Puts the corners of turned facets back.
// \param positions [V] where no guarded facet is turned
// \return whether any was put back
bool PutBack(const std::vector<GuardedFacet>& guarded,
             const std::vector<Vector3f>& positions, TriangleMesh* mesh) {
  constexpr float kMinCosine = 0.5F;  // 60 degrees, as in docs/method.md, 6.4
  bool has_turned = false;
  for (const auto& [facet, normal] : guarded) {
    if (NormalOf(*mesh, facet).dot(normal) <
        kMinCosine * normal.squaredNorm()) {
      for (const uint32_t vertex : mesh->facets[facet]) {
        has_turned |= mesh->vertices[vertex] != positions[vertex];
        mesh->vertices[vertex] = positions[vertex];
      }
    }
  }
  return has_turned;
}

}  // namespace

void SmoothBorders(const std::vector<uint8_t>& is_moved, TriangleMesh* mesh) {
  const std::vector<BorderVertex> border = FindBorderVertices(is_moved, *mesh);
  if (border.empty()) {
    return;
  }
  const std::vector<GuardedFacet> guarded = FindGuarded(border, *mesh);
  const std::vector<Vector3f> first_positions = mesh->vertices;
  for (int step = 0; step < kSteps; ++step) {
    const std::vector<Vector3f> positions = mesh->vertices;
    for (const auto& [vertex, before, after] : border) {
      const Vector3f middle = (positions[before] + positions[after]) / 2;
      mesh->vertices[vertex] = (positions[vertex] + middle) / 2;
    }
    while (PutBack(guarded, positions, mesh)) {
    }
  }
  while (PutBackIntersecting(first_positions, mesh) > 0) {
    while (PutBack(guarded, first_positions, mesh)) {
    }
  }
}

Provenance TrimAndCloseHoles(const BorderOptions& options,
                             const std::vector<float>& facet_confidences,
                             const std::vector<View>& views, Surface* surface,
                             BorderReport* report,
                             const std::vector<float>& front_shares) {
  Provenance from = IdentityOf(surface->mesh);
  if (options.trim > 0) {
    std::vector<float> gap_widths =
        Footprints(surface->mesh, surface->attributes.views, views);
    for (float& width : gap_widths) {
      width *= static_cast<float>(options.gap_pixels);
    }
    TrimmedMesh trimmed = TrimMesh(options.trim, surface->mesh,
                                   facet_confidences, gap_widths, front_shares);
    if (!trimmed.mesh.facets.empty()) {
      report->trim = trimmed.report;
      from = trimmed.from;
      surface->Become(std::move(trimmed));
    } else if (!options.is_trim_optional) {
      throw std::invalid_argument(
          "no face is confident enough: lower min_confidence");
    }
  }
  if (options.close_holes != 0) {
    report->holes = CloseHoles(
        options.close_holes,
        Footprints(surface->mesh, surface->attributes.views, views), surface);
  }
  from.vertices.resize(surface->mesh.vertices.size(), {kNone, kNone});
  from.facets.resize(surface->mesh.facets.size(), kNone);
  return from;
}

}  // namespace colmap_ext
