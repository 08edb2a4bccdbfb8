#include "mesh/vertex_confidences.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "mesh/facet_normals.h"

namespace colmap_ext {

std::vector<float> VertexConfidences(
    const TriangleMesh& mesh, const std::vector<float>& facet_confidences) {
  std::vector<double> sums(mesh.vertices.size(), 0);
  std::vector<double> angles(mesh.vertices.size(), 0);
  for (size_t i = 0; i < mesh.facets.size(); ++i) {
    for (uint32_t k = 0; k < 3; ++k) {
      const double angle = AngleVector(mesh, mesh.facets[i], k).norm();
      sums[mesh.facets[i][k]] += angle * facet_confidences[i];
      angles[mesh.facets[i][k]] += angle;
    }
  }
  std::vector<float> confidences(mesh.vertices.size(), 0);
  for (size_t i = 0; i < confidences.size(); ++i) {
    if (angles[i] > 0) {
      confidences[i] = static_cast<float>(std::min(sums[i] / angles[i], 1.0));
    }
  }
  return confidences;
}

std::vector<float> MeanOfCorners(const std::vector<Facet>& facets,
                                 const std::vector<float>& vertex_confidences) {
  std::vector<float> means;
  means.reserve(facets.size());
  for (const auto& [a, b, c] : facets) {
    means.push_back((vertex_confidences[a] + vertex_confidences[b] +
                     vertex_confidences[c]) /
                    3);
  }
  return means;
}

}  // namespace colmap_ext
