#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "mesh/triangle_mesh.h"

namespace colmap_ext {

struct Subdivision {
  TriangleMesh mesh;

  // [V] the old vertices that a new one lies between: one, twice, for an old
  // one. Old vertices keep their indices, midpoints follow in the order in
  // which the old facets' edges meet them.
  std::vector<std::array<uint32_t, 2>> sources;

  // [F] the old facet that a new one is a part of, ascending.
  std::vector<uint32_t> facet_sources;
};

// Cuts the chosen facets in four at the midpoints of their edges, and what lies
// beside them in two, three or four, so that no vertex comes to lie on an edge.
// A facet that is cut at all is cut at its longest edge too, and one that is
// cut in three along the shorter diagonal, which starts from the middle of the
// longest edge: however often facets are subdivided, their angles do not become
// sharper and sharper (Rivara 1984, Algorithms for refining triangular grids).
//
// The surface is not moved. What was manifold is so afterwards, with the same
// topology; of any other mesh too all facets at an edge share its midpoint.
//
// \param is_to_split [F]
// \pre facet indices are in range, no facet repeats a vertex, fewer than 2^32
//      vertices come out
Subdivision Subdivide(const TriangleMesh& mesh,
                      const std::vector<uint8_t>& is_to_split);

}  // namespace colmap_ext
