#pragma once

#include <cstdint>
#include <vector>

#include "mesh/triangle_mesh.h"

namespace colmap_ext {

// The facets of a manifold mesh, linked so that edges can be collapsed one by
// one. Half-edges are numbered as by PairHalfEdges: 3 * facet + k runs from the
// facet's corner k to corner k + 1.
class CollapsibleFacets {
 public:
  static constexpr uint32_t kNone = UINT32_MAX;

  // What lies around a vertex.
  struct Star {
    std::vector<uint32_t> halves;     // that leave it, counter-clockwise
    std::vector<uint32_t> neighbors;  // where they lead to; at the border one
                                      // more, the last
    bool is_border = false;
  };

  // \pre manifold
  CollapsibleFacets(std::vector<Facet> facets, size_t num_vertices);

  // Those that are gone too.
  const std::vector<Facet>& Facets() const { return facets_; }

  bool IsFacet(uint32_t facet) const { return facets_[facet][0] != kNone; }
  bool IsVertex(uint32_t vertex) const { return outgoing_[vertex] != kNone; }

  uint32_t From(uint32_t half) const { return facets_[half / 3][half % 3]; }
  uint32_t To(uint32_t half) const { return facets_[half / 3][(half + 1) % 3]; }
  uint32_t Apex(uint32_t half) const {
    return facets_[half / 3][(half + 2) % 3];
  }

  // kNone at the border.
  uint32_t Partner(uint32_t half) const { return partners_[half]; }

  void GetStar(uint32_t vertex, Star* star) const;

  // Whether the mesh stays manifold and of the same topology when an edge is
  // collapsed: the link condition (Dey, Edelsbrunner, Guha and Nekhayev 1999),
  // the border taken as one more vertex that all of its edges are joined to.
  // \param from, to  the stars of the half-edge's ends.
  bool IsCollapsible(uint32_t half, const Star& from, const Star& to);

  // Lets all facets at the half-edge's second vertex use its first one instead;
  // the one or two at the edge are gone, and so is the second vertex.
  // \pre IsCollapsible
  // \param to  the star of its second vertex.
  void Collapse(uint32_t half, const Star& to);

 private:
  static uint32_t Next(uint32_t half) {
    return half % 3 == 2 ? half - 2 : half + 1;
  }
  static uint32_t Previous(uint32_t half) {
    return half % 3 == 0 ? half + 2 : half - 1;
  }

  // Drops the half-edge's facet and joins what lies at its two other sides.
  // \return a half-edge that leaves From(half)
  uint32_t CloseFacet(uint32_t half);

  // The most clockwise half-edge around its first vertex.
  uint32_t First(uint32_t half) const;

  std::vector<Facet> facets_;       // [F] all kNone where one is gone
  std::vector<uint32_t> partners_;  // [3 F]
  std::vector<uint32_t> outgoing_;  // [V] a half-edge that leaves it, at the
                                    // border the most clockwise; kNone where
                                    // the vertex is gone
  std::vector<uint32_t> marks_;     // [V] by which test it was met last
  uint32_t num_tests_ = 0;
};

}  // namespace colmap_ext
