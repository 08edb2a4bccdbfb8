#pragma once

#include <vector>

#include "mesh/triangle_mesh.h"
#include "tests/synthetic/isosurface.h"

namespace colmap_ext::synthetic {

// Evens out the facets of a mesh of the solid's surface: every vertex is moved
// to the middle of its neighbours, in the tangent plane, and back onto the
// surface by a step of Newton's. Vertices at the border stay.
// \param cell_size the longest way of a vertex in one round, scene units
void SpreadVertices(const Solid& solid, float cell_size, int num_rounds,
                    int num_threads, TriangleMesh* mesh);

// Unit normals at the vertices, means of the facets' weighted by area.
std::vector<Eigen::Vector3f> VertexNormals(const TriangleMesh& mesh);

}  // namespace colmap_ext::synthetic
