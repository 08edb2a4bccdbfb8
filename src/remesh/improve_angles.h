#pragma once

#include <cstdint>
#include <vector>

#include "mesh/fixed_vertices.h"
#include "mesh/triangle_mesh.h"
#include "spatial/surface_point.h"

namespace colmap_ext {

struct ImprovedMesh {
  TriangleMesh mesh;                    // manifold, of the old one's topology
  std::vector<SurfacePoint> sources;    // [V] on the old mesh, nearest to each
                                        // vertex
  std::vector<uint32_t> facet_sources;  // [F] the old facet in whose place each
                                        // stands
  std::vector<uint32_t> fixed_sources;  // see RemeshedSurface
};

// Improves the facets of a mesh that have a small angle, and leaves all others
// as they are: edges are flipped, vertices moved along the surface, needles
// collapsed. No facet is turned over, none strays from the old surface by more
// than a tenth of the edges around it where its normal differs from the old
// one's, and borders stay in place.
//
// \param fixed  of the mesh
// \pre the mesh is manifold, its vertices are finite
ImprovedMesh ImproveAngles(const TriangleMesh& mesh,
                           const FixedVertices& fixed = {});

}  // namespace colmap_ext
