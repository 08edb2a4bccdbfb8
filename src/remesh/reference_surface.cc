#include "remesh/reference_surface.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "mesh/vertex_normals.h"
#include "mesh/vertex_rings.h"

namespace colmap_ext {

using Eigen::Vector3f;

ReferenceSurface::ReferenceSurface(const TriangleMesh& mesh,
                                   std::vector<float> lengths,
                                   std::vector<float> tolerances)
    : mesh_(mesh),
      lengths_(std::move(lengths)),
      tolerances_(std::move(tolerances)),
      normals_(VertexNormals(mesh, MakeVertexRings(mesh))),
      bvh_(mesh) {}

Anchor ReferenceSurface::At(const SurfacePoint& source) const {
  return {source, ValueAt(source, mesh_, normals_).normalized(),
          ValueAt(source, mesh_, lengths_),
          ValueAt(source, mesh_, tolerances_)};
}

Anchor ReferenceSurface::AtCorner(uint32_t corner) const {
  SurfacePoint source{corner / 3, Vector3f::Zero()};
  source.weights[corner % 3] = 1;
  return At(source);
}

Anchor ReferenceSurface::Nearest(const Vector3f& position,
                                 const Vector3f& normal, uint32_t hint) const {
  SurfacePoint source = NearestPointOfFacet(mesh_, hint, position);
  const float distance =
      (ValueAt(source, mesh_, mesh_.vertices) - position).norm();
  const uint32_t facet = bvh_.NearestFacet(position, normal, distance);
  if (facet != Bvh::kNoFacet) {
    source = NearestPointOfFacet(mesh_, facet, position);
  }
  return At(source);
}

bool ReferenceSurface::IsFollowedBy(
    const std::array<AnchoredCorner, 3>& facet) const {
  // With normals that agree to 20 degrees a facet strays by less than a tenth
  // of its edges.
  constexpr float kMinCosine = 0.94F;
  const Vector3f& a = facet[0].position;
  const Vector3f& b = facet[1].position;
  const Vector3f& c = facet[2].position;
  const Vector3f normal = (b - a).cross(c - a).normalized();
  float cosine = 1;
  float tolerance = facet[0].anchor->tolerance;
  for (const AnchoredCorner& corner : facet) {
    cosine = std::min(cosine, normal.dot(corner.anchor->normal));
    tolerance = std::min(tolerance, corner.anchor->tolerance);
  }
  if (cosine > kMinCosine) {
    return true;
  }
  const Vector3f samples[] = {(a + b + c) / 3, (a + b) / 2, (b + c) / 2,
                              (c + a) / 2};
  return std::ranges::all_of(samples, [&](const Vector3f& sample) {
    return std::ranges::any_of(facet,
                               [&](const AnchoredCorner& corner) {
                                 return IsNearFacet(corner.anchor->source.facet,
                                                    sample, normal, tolerance);
                               }) ||
           bvh_.IsNear(sample, normal, tolerance);
  });
}

// The quick answer for many samples, before all facets are asked.
bool ReferenceSurface::IsNearFacet(uint32_t facet, const Vector3f& position,
                                   const Vector3f& normal,
                                   float tolerance) const {
  const auto& [a, b, c] = mesh_.facets[facet];
  const Vector3f& corner = mesh_.vertices[a];
  const Vector3f across =
      (mesh_.vertices[b] - corner).cross(mesh_.vertices[c] - corner);
  const float height = across.dot(position - corner);
  return across.dot(normal) > 0 &&
         height * height < tolerance * tolerance * across.squaredNorm() &&
         (ValueAt(NearestPointOfFacet(mesh_, facet, position), mesh_,
                  mesh_.vertices) -
          position)
                 .squaredNorm() < tolerance * tolerance;
}

}  // namespace colmap_ext
