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
std::vector<double> TrustedRelief(const TriangleMesh& mesh,
                                  const VertexRings& rings,
                                  const std::vector<float>& footprints);

// How much of a relief a surface has, from none, 0, to all of it, 1: [V]. It is
// the factor of the relief that comes closest to the surface's own, in the
// surroundings of each vertex (refine/surroundings.h); 0 where they have little
// relief.
//
// A surface that was refined without regard to the relief has that of an
// accurate mesh, since both show what is there; and little of the noise of an
// inaccurate one.
//
// \param importance  [V] of the differences squared; 0 to leave a vertex out.
// \param relief, surface  [V] N . u of both.
std::vector<double> ReliefShares(const VertexRings& rings,
                                 const std::vector<double>& importance,
                                 const std::vector<double>& relief,
                                 const std::vector<double>& surface);

}  // namespace colmap_ext
