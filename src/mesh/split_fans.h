#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "mesh/surface.h"

namespace colmap_ext {

struct FanSplit : DerivedMesh {
  size_t num_split_vertices = 0;  // copies made
  size_t num_midpoints = 0;
};

// Makes a mesh manifold without moving its surface (docs/method.md, section
// 3.3). Copies each vertex once per fan. Facets belong to one fan if partners
// at the vertex connect them. Where two fans still share both ends of an edge,
// all but one get a midpoint of their own.
//
// Facets come out in the order of those that they are or are parts of, vertices
// in the order in which the facets use them; those that no facet uses are
// dropped.
//
// \param partners [3 F] PairHalfEdges(), or better pairs: where more than two
//        facets share an edge, only the cells tell which two continue each
//        other.
// \pre facet indices are in range, no facet repeats a vertex, partners run
//      their edge in opposite directions and have each other
FanSplit SplitFans(TriangleMesh mesh, std::vector<uint32_t> partners);

// By PairHalfEdges().
FanSplit SplitFans(TriangleMesh mesh);

struct ManifoldRepair : FanSplit {
  // Facets that were dropped.
  size_t num_invalid_facets = 0;     // a vertex is missing or not finite
  size_t num_degenerate_facets = 0;  // repeat a vertex
  size_t num_duplicate_facets = 0;   // have the vertices of another facet

  size_t num_unused_vertices = 0;  // dropped
};

// Makes any mesh manifold: drops facets that are invalid, degenerate or
// duplicates, then vertices without a facet, and splits the fans of the rest by
// SplitFans(). Where two facets run an edge in the same direction, or more than
// two share it, all of them come apart there.
ManifoldRepair RepairManifold(const TriangleMesh& mesh);

}  // namespace colmap_ext
