#pragma once

#include <vector>

#include <Eigen/Core>

#include "mesh/triangle_mesh.h"
#include "mesh/vertex_rings.h"

namespace colmap_ext {

// Returns [V] unit normals: the sum of the facets' normals, weighted by their
// angles at the vertex [Thuermer1998]; zero where there is none.
// \param rings  MakeVertexRings() of the mesh, at any positions of its vertices
std::vector<Eigen::Vector3f> VertexNormals(const TriangleMesh& mesh,
                                           const VertexRings& rings);

}  // namespace colmap_ext
