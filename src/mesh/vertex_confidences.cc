#include "mesh/vertex_confidences.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace colmap_ext {
namespace {

double AngleAt(const TriangleMesh& mesh, const Facet& facet, int corner) {
  const Eigen::Vector3d origin = mesh.vertices[facet[corner]].cast<double>();
  const Eigen::Vector3d u =
      mesh.vertices[facet[(corner + 1) % 3]].cast<double>() - origin;
  const Eigen::Vector3d v =
      mesh.vertices[facet[(corner + 2) % 3]].cast<double>() - origin;
  return std::atan2(u.cross(v).norm(), u.dot(v));
}

}  // namespace

std::vector<float> VertexConfidences(
    const TriangleMesh& mesh, const std::vector<float>& facet_confidences) {
  std::vector<double> sums(mesh.vertices.size(), 0);
  std::vector<double> angles(mesh.vertices.size(), 0);
  for (size_t i = 0; i < mesh.facets.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      const double angle = AngleAt(mesh, mesh.facets[i], k);
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
