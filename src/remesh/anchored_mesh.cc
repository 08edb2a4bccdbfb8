#include "remesh/anchored_mesh.h"

#include "mesh/normals.h"

namespace colmap_ext {

using Eigen::Vector3f;

ReferenceSurface::ReferenceSurface(const TriangleMesh& mesh,
                                   std::vector<float> lengths,
                                   std::vector<float> tolerances)
    : mesh_(mesh),
      lengths_(std::move(lengths)),
      tolerances_(std::move(tolerances)),
      normals_(VertexNormals(mesh, MakeVertexRings(mesh))),
      partners_(PairHalfEdges(mesh.facets)),
      bvh_(mesh) {}

Anchor ReferenceSurface::At(const SurfacePoint& source) const {
  return {source, ValueAt(source, mesh_, normals_).normalized(),
          ValueAt(source, mesh_, lengths_),
          ValueAt(source, mesh_, tolerances_)};
}

// From facet to neighboring facet while these are nearer, so that little is
// left to search.
ReferenceSurface::NearPoint ReferenceSurface::Descend(const Vector3f& position,
                                                      const Vector3f& normal,
                                                      uint32_t facet) const {
  NearPoint nearest = NearestIn(facet, position);
  for (uint32_t k = 0; k < 3;) {
    const uint32_t partner = partners_[3 * nearest.point.facet + k];
    const bool is_at_edge = nearest.point.weights[(k + 2) % 3] <= 0;
    ++k;
    if (is_at_edge && partner != kNone &&
        AreaVector(mesh_, mesh_.facets[partner / 3]).dot(normal) > 0) {
      const NearPoint across = NearestIn(partner / 3, position);
      if (across.distance < nearest.distance) {
        nearest = across;
        k = 0;
      }
    }
  }
  return nearest;
}

Anchor ReferenceSurface::Nearest(const Vector3f& position,
                                 const Vector3f& normal, uint32_t hint) const {
  const NearPoint near = Descend(position, normal, hint);
  const uint32_t facet = bvh_.NearestFacet(position, normal, near.distance);
  return At(facet != kNone ? NearestIn(facet, position).point : near.point);
}

bool ReferenceSurface::IsFollowedBy(const AnchoredFacet& facet) const {
  // With normals that agree to 20 degrees a facet strays by less than a tenth
  // of its edges.
  constexpr float kMinCosine = 0.94F;
  const Vector3f& a = facet[0].position;
  const Vector3f& b = facet[1].position;
  const Vector3f& c = facet[2].position;
  const Vector3f normal = AreaVector(facet).normalized();
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

ReferenceSurface::NearPoint ReferenceSurface::NearestIn(
    uint32_t facet, const Vector3f& position) const {
  const SurfacePoint point = NearestPointOfFacet(mesh_, facet, position);
  return {point, (ValueAt(point, mesh_, mesh_.vertices) - position).norm()};
}

// The quick answer for many samples, before all facets are asked.
bool ReferenceSurface::IsNearFacet(uint32_t facet, const Vector3f& position,
                                   const Vector3f& normal,
                                   float tolerance) const {
  const Vector3f& corner = mesh_.vertices[mesh_.facets[facet][0]];
  const Vector3f across = AreaVector(mesh_, mesh_.facets[facet]);
  const float height = across.dot(position - corner);
  return across.dot(normal) > 0 &&
         height * height < tolerance * tolerance * across.squaredNorm() &&
         NearestIn(facet, position).distance < tolerance;
}

AnchoredMesh::AnchoredMesh(const TriangleMesh& mesh, std::vector<float> lengths,
                           std::vector<float> tolerances,
                           FixedVertices fixed_vertices)
    : reference(mesh, std::move(lengths), std::move(tolerances)),
      edit(mesh),
      anchors(mesh.vertices.size()),
      fixed(std::move(fixed_vertices)) {
  std::vector<uint32_t> corners(mesh.vertices.size(), kNone);
  for (uint32_t corner = 0; corner < 3 * mesh.facets.size(); ++corner) {
    corners[FromVertex(mesh.facets, corner)] = corner;
  }
  tbb::parallel_for(size_t{0}, corners.size(), [&](size_t i) {
    if (corners[i] != kNone) {
      anchors[i] =
          reference.At({corners[i] / 3, Vector3f::Unit(corners[i] % 3)});
    }
  });
}

float LargestCosine(const AnchoredFacet& facet) {
  const Vector3f ab = facet[1].position - facet[0].position;
  const Vector3f bc = facet[2].position - facet[1].position;
  const Vector3f ca = facet[0].position - facet[2].position;
  const float lengths[] = {ab.norm(), bc.norm(), ca.norm()};
  if (!(ab.cross(ca).norm() > 0)) {
    return 2;
  }
  return std::max({-ab.dot(ca) / (lengths[0] * lengths[2]),
                   -bc.dot(ab) / (lengths[1] * lengths[0]),
                   -ca.dot(bc) / (lengths[2] * lengths[1])});
}

bool KeepsFacing(const AnchoredFacet& before, const AnchoredFacet& after,
                 float min_cosine) {
  constexpr float kMaxCosine = 0.9998F;  // 1 degree
  const Vector3f normal = AreaVector(after);
  if (LargestCosine(before) < kMaxCosine) {
    const Vector3f old_normal = AreaVector(before);
    return normal.dot(old_normal) >
           min_cosine * normal.norm() * old_normal.norm();
  }
  return normal.dot(after[0].anchor->normal + after[1].anchor->normal +
                    after[2].anchor->normal) > 0;
}

}  // namespace colmap_ext
