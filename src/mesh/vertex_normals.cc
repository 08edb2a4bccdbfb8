#include "mesh/vertex_normals.h"

#include <tbb/parallel_for.h>

#include "mesh/facet_normals.h"

namespace colmap_ext {

using Eigen::Vector3d;
using Eigen::Vector3f;

std::vector<Vector3f> VertexNormals(const TriangleMesh& mesh,
                                    const VertexRings& rings) {
  std::vector<Vector3f> normals(mesh.vertices.size());
  tbb::parallel_for(size_t{0}, normals.size(), [&](size_t vertex) {
    Vector3d sum = Vector3d::Zero();
    for (const uint32_t corner : rings.corners[vertex]) {
      sum += AngleVector(mesh, mesh.facets[corner / 3], corner % 3);
    }
    const double norm = sum.norm();
    normals[vertex] =
        norm > 0 ? Vector3f((sum / norm).cast<float>()) : Vector3f::Zero();
  });
  return normals;
}

}  // namespace colmap_ext
