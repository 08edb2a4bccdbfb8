#pragma once

#include <vector>

#include "mesh/adjacency.h"
#include "mesh/surface.h"
#include "mesh/triangle_mesh.h"
#include "spatial/facet_tree.h"

namespace colmap_ext {

// Limits each vertex's motion along its normal to 0.4 times the mean length of
// its edges (with less than half of it no two neighbors can pass each other)
// and to the footprint of a pixel.
// \param footprints  [V] scene units
// \param motion  [V] scene units
void LimitMotion(const TriangleMesh& mesh, const VertexRings& rings,
                 const std::vector<float>& footprints,
                 std::vector<double>* motion);

struct MovedMesh {
  TriangleMesh mesh;
  std::vector<double> motion;         // [V] along the normals, scene units
  std::vector<uint8_t> is_shortened;  // [V] moved by less than `motion` asked
};

// Moves the vertices along their normals. Those of facets that would turn by
// more than 60 degrees, or that would intersect (FindSelfIntersections) and do
// not so far, go half as far, up to four times, then not at all. So the result
// has no self-intersection that the mesh does not have.
// \param rings  MakeVertexRings(mesh)
// \param normals  [V] unit
// \param motion  [V] scene units
// \param tree  of the mesh's facets; its boxes change
MovedMesh MoveSafely(const TriangleMesh& mesh, const VertexRings& rings,
                     const std::vector<Eigen::Vector3f>& normals,
                     std::vector<double> motion, FacetTree* tree);

// The mean of the motion of the vertices that may move, px.
double MeanMotion(const std::vector<double>& motion,
                  const std::vector<float>& footprints,
                  const FixedVertices& fixed = {});

}  // namespace colmap_ext
