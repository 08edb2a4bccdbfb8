#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "mesh/triangle_mesh.h"

namespace colmap_ext {

struct EdgeCollapse {
  TriangleMesh mesh;

  // [V] the old vertex that a new one takes its target length from: of those
  // that were collapsed into it, one that it came to lie close to. Ascending,
  // no repeats.
  std::vector<uint32_t> sources;

  // [F] the old facet that a new one is, with other corners. Ascending, no
  // repeats.
  std::vector<uint32_t> facet_sources;
};

// Collapses the edges that are shorter than their target, the shortest in
// targets first, until there is none left that can be. The target of an edge is
// the smaller of those of its ends.
//
// What becomes of an edge is put where the squared distances to the planes of
// all facets that went into it are least (Garland and Heckbert 1997), or else
// at one of the edge's ends if that is hardly worse. Edges of the border have
// planes too, that stand upright on their facets; they collapse along the
// border, and inner edges that end at the border collapse to that end: a
// straight border stays where it is.
//
// An edge is left alone if the mesh did not stay manifold, of the same topology
// and with all of its components; or if around it
// - a facet turned by more than 60 degrees,
// - a facet became a sliver or, if it is one, a thinner one,
// - an edge became longer than 1.5 targets, if it was not before,
// - a vertex got more than 12 neighbours, if neither end had as many.
//
// Facets that lie on top of each other are not seen: surfaces that come closer
// to each other than their edges are long may come to intersect.
//
// \param target_lengths  [V] scene units; where it is zero or less, or not a
//        number, edges are left alone.
// \pre mesh manifold
EdgeCollapse CollapseShortEdges(const TriangleMesh& mesh,
                                const std::vector<float>& target_lengths);

}  // namespace colmap_ext
