#include "mesh/vertex_normals.h"

#include <cmath>

#include <tbb/parallel_for.h>
#include <Eigen/Geometry>

namespace colmap_ext {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

// The facet's normal, as long as its angle at a corner.
Vector3d AngleVector(const TriangleMesh& mesh, const Facet& facet, int corner) {
  const Vector3d origin = mesh.vertices[facet[corner]].cast<double>();
  const Vector3d u =
      mesh.vertices[facet[(corner + 1) % 3]].cast<double>() - origin;
  const Vector3d v =
      mesh.vertices[facet[(corner + 2) % 3]].cast<double>() - origin;
  const Vector3d normal = u.cross(v);
  const double norm = normal.norm();
  return norm > 0 ? Vector3d(std::atan2(norm, u.dot(v)) / norm * normal)
                  : Vector3d::Zero();
}

}  // namespace

std::vector<Vector3f> VertexNormals(const TriangleMesh& mesh,
                                    const VertexRings& rings) {
  std::vector<Vector3f> normals(mesh.vertices.size());
  tbb::parallel_for(size_t{0}, normals.size(), [&](size_t vertex) {
    Vector3d sum = Vector3d::Zero();
    for (const uint32_t corner : rings.corners[vertex]) {
      sum += AngleVector(mesh, mesh.facets[corner / 3],
                         static_cast<int>(corner % 3));
    }
    const double norm = sum.norm();
    normals[vertex] =
        norm > 0 ? Vector3f((sum / norm).cast<float>()) : Vector3f::Zero();
  });
  return normals;
}

}  // namespace colmap_ext
