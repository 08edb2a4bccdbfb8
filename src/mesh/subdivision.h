#pragma once

#include <cstdint>
#include <vector>

#include "mesh/surface.h"

namespace colmap_ext {

// Cuts the chosen facets in four at the midpoints of their edges, and facets
// beside them in two, three or four, so that no vertex lies on an edge. A facet
// that is cut at all is cut at its longest edge too, and one that is cut in
// three along the shorter diagonal, which starts from the middle of the longest
// edge. So angles do not become ever sharper, however often facets are
// subdivided [Rivara1984].
//
// The surface does not move, and the mesh keeps its topology. Old vertices keep
// their indices, midpoints follow in the order of the old half-edges; facets
// are in the order of those that they are parts of.
//
// \param is_to_split [F] not 0: chosen
// \param fixed  of the mesh: edges between them are not cut
// \pre the mesh is manifold, fewer than 2^32 vertices come out
DerivedMesh Subdivide(const TriangleMesh& mesh,
                      const std::vector<uint8_t>& is_to_split,
                      const FixedVertices& fixed = {});

}  // namespace colmap_ext
