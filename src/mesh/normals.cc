#include "mesh/normals.h"

#include <cmath>

#include <tbb/parallel_for.h>

namespace colmap_ext {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

// Twice the facet's area, along its normal.
Vector3d AreaVector(const std::vector<Vector3f>& vertices, const Facet& facet) {
  const Vector3d a = vertices[facet[0]].cast<double>();
  const Vector3d b = vertices[facet[1]].cast<double>();
  const Vector3d c = vertices[facet[2]].cast<double>();
  return (b - a).cross(c - a);
}

// Of no length where the vector has none.
Vector3d Unit(const Vector3d& vector) {
  const double norm = vector.norm();
  return norm > 0 ? Vector3d(vector / norm) : Vector3d::Zero();
}

}  // namespace

std::vector<Vector3f> FacetNormals(const TriangleMesh& mesh) {
  std::vector<Vector3f> normals(mesh.facets.size());
  tbb::parallel_for(size_t{0}, normals.size(), [&](size_t facet) {
    normals[facet] = FacetNormal(mesh, facet);
  });
  return normals;
}

Vector3f FacetNormal(const TriangleMesh& mesh, size_t facet) {
  return Unit(AreaVector(mesh.vertices, mesh.facets[facet])).cast<float>();
}

Vector3d AngleVector(const TriangleMesh& mesh, const Facet& facet,
                     uint32_t corner) {
  const auto corners = CornersOf<double>(mesh, facet);
  const Vector3d u = corners[(corner + 1) % 3] - corners[corner];
  const Vector3d v = corners[(corner + 2) % 3] - corners[corner];
  const Vector3d normal = u.cross(v);
  const double norm = normal.norm();
  return norm > 0 ? Vector3d(std::atan2(norm, u.dot(v)) / norm * normal)
                  : Vector3d::Zero();
}

std::vector<Vector3f> VertexNormals(const TriangleMesh& mesh,
                                    const VertexRings& rings) {
  std::vector<Vector3f> normals(mesh.vertices.size());
  tbb::parallel_for(size_t{0}, normals.size(), [&](size_t vertex) {
    Vector3d sum = Vector3d::Zero();
    for (const uint32_t corner : rings.corners[vertex]) {
      sum += AngleVector(mesh, mesh.facets[corner / 3], corner % 3);
    }
    normals[vertex] = Unit(sum).cast<float>();
  });
  return normals;
}

}  // namespace colmap_ext
