#pragma once

#include <cstdint>
#include <vector>

#include "mesh/surface.h"
#include "mesh/triangle_mesh.h"
#include "spatial/bvh.h"

namespace colmap_ext {

// How fast lengths may grow over the surface: a choice, with which neighboring
// facets hardly differ in size.
inline constexpr float kGradation = 0.3F;

// Returns [V] the mean length of the edges at each vertex, scene units;
// smoothed over its neighbors. Zero where a vertex has no facet.
std::vector<float> MeanEdgeLengths(const TriangleMesh& mesh);

// Returns [V] the length with which edges stray from the surface by no more
// than a tolerance: sqrt(6 tolerance / curvature - 3 tolerance^2) [Dunyach2013,
// section 3.2], with the largest curvature along the edges of a vertex.
// Infinite where the surface is flat, a vertex has no facet, or its tolerance
// is infinite.
// \param tolerances [V] scene units, positive
// \pre facet indices < V
std::vector<float> LengthsForCurvature(const TriangleMesh& mesh,
                                       const std::vector<float>& tolerances);

// Lowers lengths so that they grow along no edge by more than `gradation` times
// the edge's length.
// \param lengths [V] scene units, may be infinite
// \pre gradation > 0, facet indices < V
void LimitGradation(const TriangleMesh& mesh, float gradation,
                    std::vector<float>* lengths);

// Returns [V] how far a remeshed surface may stray for facets of such lengths:
// a tenth of them, about as far as the middle of an edge strays from a surface
// whose normals turn by 25 degrees over it.
std::vector<float> TolerancesOf(std::vector<float> lengths);

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
