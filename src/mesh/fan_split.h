#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "mesh/triangle_mesh.h"

namespace colmap_ext {

// A facet's half-edge 3 * facet + k runs from its corner k to corner k + 1.
inline constexpr uint32_t kNoPartner = UINT32_MAX;

// The other half-edge of each half-edge's edge, where exactly two facets share
// the edge and run it in opposite directions; else kNoPartner.
std::vector<uint32_t> PairHalfEdges(const std::vector<Facet>& facets);

struct FanSplit {
  TriangleMesh mesh;
  // [V], the old vertices that a new one came from: one, twice, or the ends of
  // the edge whose midpoint it is.
  std::vector<std::array<uint32_t, 2>> sources;
  size_t num_split_vertices = 0;  // copies made
  size_t num_midpoints = 0;
};

// Makes a mesh manifold without moving its surface: each vertex is copied once
// per fan, a fan being the facets that are reached from each other across
// paired edges around the vertex. Where two sheets still share both ends of an
// edge (a fan that touches itself along it), all but one get a midpoint of
// their own. Vertices that no facet uses are dropped. Vertices come out in the
// order in which the facets use them, midpoints last. Facets keep their order;
// those that a midpoint cuts off come last.
//
// \param partners [3 F] from PairHalfEdges, or better: where more than two
//        facets share an edge it takes more than the mesh to tell which two
//        are one surface.
// \pre facet indices are in range, no facet repeats a vertex, partners run
//      their edge in opposite directions
FanSplit SplitFans(const TriangleMesh& mesh,
                   const std::vector<uint32_t>& partners);

}  // namespace colmap_ext
