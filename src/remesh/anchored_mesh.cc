#include "remesh/anchored_mesh.h"

#include <algorithm>
#include <utility>

namespace colmap_ext {

AnchoredMesh::AnchoredMesh(const TriangleMesh& mesh,
                           const ReferenceSurface& reference,
                           FixedVertices fixed_vertices)
    : edit(mesh),
      anchors(mesh.vertices.size()),
      fixed(std::move(fixed_vertices)) {
  for (uint32_t facet = 0; facet < mesh.facets.size(); ++facet) {
    for (uint32_t k = 0; k < 3; ++k) {
      anchors[mesh.facets[facet][k]] = reference.AtCorner(3 * facet + k);
    }
  }
}

float LargestCosine(const Eigen::Vector3f& a, const Eigen::Vector3f& b,
                    const Eigen::Vector3f& c) {
  const Eigen::Vector3f ab = b - a;
  const Eigen::Vector3f bc = c - b;
  const Eigen::Vector3f ca = a - c;
  const float lengths[] = {ab.norm(), bc.norm(), ca.norm()};
  if (!(ab.cross(ca).norm() > 0)) {
    return 2;
  }
  return std::max({-ab.dot(ca) / (lengths[0] * lengths[2]),
                   -bc.dot(ab) / (lengths[1] * lengths[0]),
                   -ca.dot(bc) / (lengths[2] * lengths[1])});
}

float LargestCosine(const std::array<AnchoredCorner, 3>& facet) {
  return LargestCosine(facet[0].position, facet[1].position, facet[2].position);
}

bool KeepsFacing(const std::array<AnchoredCorner, 3>& before,
                 const std::array<AnchoredCorner, 3>& after, float min_cosine) {
  constexpr float kMaxCosine = 0.9998F;  // 1 degree
  const auto area_vector =
      [](const std::array<AnchoredCorner, 3>& facet) -> Eigen::Vector3f {
    return (facet[1].position - facet[0].position)
        .cross(facet[2].position - facet[0].position);
  };
  const Eigen::Vector3f normal = area_vector(after);
  if (LargestCosine(before) < kMaxCosine) {
    const Eigen::Vector3f old_normal = area_vector(before);
    return normal.dot(old_normal) >
           min_cosine * normal.norm() * old_normal.norm();
  }
  return normal.dot(after[0].anchor->normal + after[1].anchor->normal +
                    after[2].anchor->normal) > 0;
}

}  // namespace colmap_ext
