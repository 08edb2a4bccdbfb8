#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "mesh/triangle_mesh.h"

namespace colmap_ext {

struct FanSplit {
  TriangleMesh mesh;

  // [V] the two old vertices that a new one comes from: the ends of the edge
  // whose midpoint it is, or twice the vertex that it is a copy of.
  std::vector<std::array<uint32_t, 2>> sources;

  // Of the facets after the old ones, which midpoints cut off: the old facet
  // that each is a part of. Empty after OrderByUse().
  std::vector<uint32_t> cut_facets;

  size_t num_split_vertices = 0;  // copies made
  size_t num_midpoints = 0;
};

// Makes a mesh manifold without moving its surface (docs/method.md, section
// 3.3). Copies each vertex once per fan. Facets belong to one fan if partners
// at the vertex connect them. Where two fans still share both ends of an edge,
// all but one get a midpoint of their own.
//
// Vertices come out in the order in which the facets use them, midpoints last;
// those that no facet uses are dropped. Facets keep their order; those that a
// midpoint cuts off come last.
//
// \param partners [3 F] PairHalfEdges(), or better pairs: where more than two
//        facets share an edge, only the cells tell which two continue each
//        other.
// \pre facet indices are in range, no facet repeats a vertex, partners run
//      their edge in opposite directions and have each other
FanSplit SplitFans(TriangleMesh mesh, std::vector<uint32_t> partners);

// Puts the facets in the order of those that they are parts of, and vertices in
// the order in which the facets use them: where no midpoint was made, they are
// so.
void OrderByUse(FanSplit* split);

}  // namespace colmap_ext
