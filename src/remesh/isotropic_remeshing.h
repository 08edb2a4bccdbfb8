#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "mesh/fixed_vertices.h"
#include "mesh/triangle_mesh.h"
#include "spatial/surface_point.h"

namespace colmap_ext {

struct RemeshedSurface {
  TriangleMesh mesh;                    // manifold, of the old one's topology
  std::vector<SurfacePoint> sources;    // [V] on the old mesh, nearest to each
                                        // vertex
  std::vector<uint32_t> fixed_sources;  // [V] the old vertex that one that
                                        // stays was, or kNone; empty where
                                        // none stays
};

// Gives a mesh well-shaped facets of a wanted size: long edges are split, short
// ones collapsed, edges flipped, vertices moved along the surface [Botsch2004],
// with a length that varies over the surface [Dunyach2013]. No facet is turned
// over, none strays from the old surface by more than the tolerance where its
// normal differs from the old one's, and borders stay in place.
//
// \param lengths [V] of edges, wanted at the vertices, scene units, positive;
//        they should vary slowly: LimitGradation()
// \param tolerances [V] scene units, positive
// \param fixed  of the mesh
// \pre the mesh is manifold, its vertices are finite
RemeshedSurface RemeshIsotropically(const TriangleMesh& mesh,
                                    const std::vector<float>& lengths,
                                    const std::vector<float>& tolerances,
                                    const FixedVertices& fixed = {});

}  // namespace colmap_ext
