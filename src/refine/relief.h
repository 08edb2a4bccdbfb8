#pragma once

#include <vector>

#include "mesh/triangle_mesh.h"
#include "mesh/vertex_rings.h"

namespace colmap_ext {

// The relief of a surface, N . u at each vertex: the umbrella operator u along
// the normal (refine/thin_plate.h). [V] scene units.
// \param footprints  [V] of a pixel, scene units.
std::vector<double> Relief(const TriangleMesh& mesh, const VertexRings& rings,
                           const std::vector<float>& footprints);

// The part of the relief that is trusted before any image is seen. It is
// averaged over a ring, as differences between neighbors are noise of the
// points; and it is 0 at borders, and where the surface is curved as spikes
// are. [V] scene units
std::vector<double> TrustedRelief(const TriangleMesh& mesh,
                                  const VertexRings& rings,
                                  const std::vector<float>& footprints);

// The share of a given relief that a surface has, from 0 to 1: [V] the factor
// of the relief that comes closest to the surface's own in the surroundings of
// each vertex (refine/surroundings.h); 0 where these have little relief
// (docs/method.md, section 6.6).
//
// A surface that was refined without regard to the relief has that of an
// accurate mesh, since both show what is there, and little of the noise of an
// inaccurate one.
//
// \param importance  [V] of the squared differences; 0 leaves a vertex out.
// \param relief, surface  [V] N . u of both, scene units.
std::vector<double> ReliefShares(const VertexRings& rings,
                                 const std::vector<double>& importance,
                                 const std::vector<double>& relief,
                                 const std::vector<double>& surface);

}  // namespace colmap_ext
