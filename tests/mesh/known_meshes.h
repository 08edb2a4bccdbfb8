#pragma once

#include <cstdint>

#include "mesh/triangle_mesh.h"
#include "tests/random.h"

// Meshes whose topology is known.
namespace colmap_ext {

TriangleMesh MakeTetrahedron();

TriangleMesh MakeCube();

// A sheet of quads, each of them two facets, of num_rows x num_cols quads,
// closed to a ring along the columns or the rows where it wraps.
// \pre at least 3 quads where it wraps
TriangleMesh MakeSheet(uint32_t num_rows, uint32_t num_cols,
                       bool wraps_rows = false, bool wraps_cols = false);

TriangleMesh MakeTorus();
TriangleMesh MakeDisc();
TriangleMesh MakeAnnulus();

// One-sided: some edge is run twice in one direction, however it is oriented.
TriangleMesh MakeMoebiusStrip();

// The mesh with each vertex where function(position) says.
template <typename Function>
TriangleMesh Moved(TriangleMesh mesh, const Function& function) {
  for (Eigen::Vector3f& vertex : mesh.vertices) {
    vertex = function(vertex);
  }
  return mesh;
}

inline TriangleMesh Shifted(const TriangleMesh& mesh,
                            const Eigen::Vector3f& shift) {
  return Moved(mesh, [&](const auto& point) { return point + shift; });
}

// Two tetrahedra that touch with their first vertices.
TriangleMesh MakeTipToTip();

// Both meshes side by side.
TriangleMesh Union(const TriangleMesh& a, const TriangleMesh& b);

// Lets all facets use vertex `to` instead of `from`, which is then unreferenced
// and removed.
void MergeVertices(uint32_t from, uint32_t to, TriangleMesh* mesh);

// Uniform in the unit cube.
Eigen::Vector3f RandomPoint(Random* random);

// Facets between random ones of few vertices, at random positions: edges and
// vertices of all kinds. No facet repeats a vertex.
// \param allow_duplicates of facets
TriangleMesh RandomSoup(uint32_t num_vertices, uint32_t num_facets,
                        bool allow_duplicates, Random* random);

}  // namespace colmap_ext
