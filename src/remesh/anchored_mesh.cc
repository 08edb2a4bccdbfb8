#include "remesh/anchored_mesh.h"

#include <algorithm>

namespace colmap_ext {

AnchoredMesh::AnchoredMesh(const TriangleMesh& mesh,
                           const ReferenceSurface& reference)
    : edit(mesh), anchors(mesh.vertices.size()) {
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

}  // namespace colmap_ext
