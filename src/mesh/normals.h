#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

#include "mesh/adjacency.h"
#include "mesh/triangle_mesh.h"

namespace colmap_ext {

// Returns [F] unit normals, to the side from which the corners run
// counter-clockwise; zero where a facet has no area.
// \pre facet indices are in range
std::vector<Eigen::Vector3f> FacetNormals(const TriangleMesh& mesh);

// Returns one of them.
// \pre facet < F, its indices are in range
Eigen::Vector3f FacetNormal(const TriangleMesh& mesh, size_t facet);

// Returns a facet's normal, as long as twice its area, scene units squared.
inline Eigen::Vector3f AreaVector(const TriangleMesh& mesh,
                                  const Facet& facet) {
  const Eigen::Vector3f& corner = mesh.vertices[facet[0]];
  return (mesh.vertices[facet[1]] - corner)
      .cross(mesh.vertices[facet[2]] - corner);
}

// Returns a facet's normal, as long as its angle at a corner, radians; zero
// where the facet has no area.
// \param corner  0, 1 or 2
// \pre the facet's indices are in range
Eigen::Vector3d AngleVector(const TriangleMesh& mesh, const Facet& facet,
                            uint32_t corner);

// Returns [V] unit normals: the sum of the facets' normals, weighted by their
// angles at the vertex [Thuermer1998]; zero where there is none.
// \param rings  MakeVertexRings() of the mesh, at any positions of its vertices
std::vector<Eigen::Vector3f> VertexNormals(const TriangleMesh& mesh,
                                           const VertexRings& rings);

}  // namespace colmap_ext
