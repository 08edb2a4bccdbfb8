#pragma once

#include <vector>

#include <Eigen/Core>

#include "mesh/triangle_mesh.h"
#include "mesh/vertex_rings.h"

namespace colmap_ext {

// [V] the facets' normals added up by their angles at the vertex (Thuermer and
// Wuethrich 1998), unit; zero where there is none.
// \param rings  of the mesh's facets, wherever its vertices are
std::vector<Eigen::Vector3f> VertexNormals(const TriangleMesh& mesh,
                                           const VertexRings& rings);

}  // namespace colmap_ext
