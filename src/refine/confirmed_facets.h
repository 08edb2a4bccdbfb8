#pragma once

#include <cstdint>
#include <vector>

#include "mesh/triangle_mesh.h"
#include "mesh/vertex_rings.h"
#include "photometry/photometric_energy.h"

namespace colmap_ext {

// [F] whether the images agree on a surface well enough to refine it. If they
// show something else than the surface, such as the sky through a membrane
// between two roofs, correlation is low all around, and refinement would only
// add false relief. The correlation is taken from the surroundings of each
// vertex (refine/surroundings.h), so that edges and highlights have no effect.
// \param terms [F] of the surface
// \param min_zncc  that the surroundings need; -1 or less: none.
std::vector<uint8_t> ConfirmedFacets(const TriangleMesh& mesh,
                                     const VertexRings& rings,
                                     const PhotometricTerms& terms,
                                     const PhotometricOptions& options,
                                     double min_zncc);

}  // namespace colmap_ext
