#pragma once

#include <cstdint>
#include <vector>

#include "mesh/surface.h"
#include "spatial/bvh.h"

namespace colmap_ext {

// Returns the attributes of points on a mesh: colours and confidences
// between those of the facet's corners, and the views of any corner that has a
// part in it.
// \param attributes [V] of the mesh
// \param points [N]
VertexAttributes CarryAttributes(const TriangleMesh& mesh,
                                 const VertexAttributes& attributes,
                                 const std::vector<SurfacePoint>& points);

struct RemeshedSurface {
  TriangleMesh mesh;                    // manifold, of the old one's topology
  std::vector<SurfacePoint> sources;    // [V] on the old mesh, nearest to each
                                        // vertex
  FixedSources fixed_sources;           // [V] of the old mesh's vertices
  std::vector<uint32_t> facet_sources;  // [F] the old facet in whose place each
                                        // stands; RemeshIsotropically(): empty
};

// Lets a surface become what it was remeshed to, with the attributes of
// CarryAttributes() and the origins between those of the facets' corners.
void BecomeRemeshed(RemeshedSurface remeshed, Surface* surface);

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

// Improves the facets of a mesh that have a small angle, and leaves all others
// as they are: edges are flipped, vertices moved along the surface, needles
// collapsed. No facet is turned over, none strays from the old surface by more
// than a tenth of the edges around it where its normal differs from the old
// one's, and borders stay in place.
//
// \param fixed  of the mesh
// \pre the mesh is manifold, its vertices are finite
RemeshedSurface ImproveAngles(const TriangleMesh& mesh,
                              const FixedVertices& fixed = {});

// Remeshes a surface with facets of the size that those in each neighborhood
// have on average: their shapes become even, their number stays about the same.
// \pre the mesh is manifold, its vertices are finite
void RemeshEvenly(Surface* surface);

}  // namespace colmap_ext
