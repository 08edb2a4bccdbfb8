#pragma once

#include <vector>

#include "mesh/triangle_mesh.h"
#include "mesh/vertex_rings.h"

namespace colmap_ext {

// N . u at each vertex, the umbrella operator u along the normal as ThinPlate
// has it: [V] scene units, 0 at borders.
// \param footprints  [V] of a pixel, scene units.
std::vector<double> Relief(const TriangleMesh& mesh, const VertexRings& rings,
                           const std::vector<float>& footprints);

// What of it can be trusted before any picture has been looked at: relief of
// several vertices' extent. What differs from vertex to vertex is the noise of
// the points that the surface was made from, and is averaged out; and what is
// curved with a radius of a few pixels only is one of its spikes, and left out.
//
// A refined surface that is to have this relief, rather than none, keeps what
// is fine but true where the pictures are too noisy to show it; and of the
// noise of a mesh from noisy points, what several of its vertices share.
std::vector<double> TrustedRelief(const TriangleMesh& mesh,
                                  const VertexRings& rings,
                                  const std::vector<float>& footprints);

}  // namespace colmap_ext
