#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "mesh/fixed_vertices.h"
#include "mesh/triangle_mesh.h"

namespace colmap_ext {

struct Subdivision {
  TriangleMesh mesh;

  // [V] the ends of the edge whose midpoint a vertex is, or twice the vertex
  // itself. Old vertices keep their indices, midpoints follow in the order of
  // the old half-edges.
  std::vector<std::array<uint32_t, 2>> sources;

  // [F] the old facet that a new one is a part of, ascending.
  std::vector<uint32_t> facet_sources;
};

// Cuts the chosen facets in four at the midpoints of their edges, and facets
// beside them in two, three or four, so that no vertex lies on an edge. A facet
// that is cut at all is cut at its longest edge too, and one that is cut in
// three along the shorter diagonal, which starts from the middle of the longest
// edge. So angles do not become ever sharper, however often facets are
// subdivided [Rivara1984].
//
// The surface does not move. A manifold mesh stays manifold, with the same
// topology; in any other mesh all facets at an edge share its midpoint, too.
//
// \param is_to_split [F] not 0: chosen
// \param fixed  of the mesh: edges between them are not cut
// \pre facet indices are in range, no facet repeats a vertex, fewer than 2^32
//      vertices come out
Subdivision Subdivide(const TriangleMesh& mesh,
                      const std::vector<uint8_t>& is_to_split,
                      const FixedVertices& fixed = {});

}  // namespace colmap_ext
