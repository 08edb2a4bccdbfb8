#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "mesh/adjacency.h"
#include "mesh/surface.h"

namespace colmap_ext {

// A manifold triangle mesh, with or without borders, whose edges can be split,
// collapsed and flipped. Half-edges are those of mesh/adjacency.h; an index of
// a facet or vertex keeps its meaning until it is removed. Each operation
// leaves a manifold mesh of the same topology.
class EditableMesh {
 public:
  // \pre every edge has at most two facets, which run it in opposite
  //      directions, and the facets of each vertex form one fan
  explicit EditableMesh(const TriangleMesh& mesh)
      : EditableMesh(mesh, PairHalfEdges(mesh.facets)) {}

  // By these partners of its half-edges instead of PairHalfEdges(): facets that
  // are no partners are no neighbors.
  EditableMesh(TriangleMesh mesh, std::vector<uint32_t> partners);

  // With what was removed.
  const TriangleMesh& mesh() const { return mesh_; }
  const std::vector<uint32_t>& partners() const { return partners_; }

  // Sizes include what was removed.
  size_t NumVertices() const { return mesh_.vertices.size(); }
  size_t NumFacets() const { return mesh_.facets.size(); }
  size_t NumHalfEdges() const { return partners_.size(); }

  bool IsRemovedVertex(uint32_t vertex) const {
    return outgoing_[vertex] == kNone;
  }
  bool IsRemovedFacet(uint32_t facet) const {
    return mesh_.facets[facet][0] == mesh_.facets[facet][1];
  }

  const Eigen::Vector3f& Position(uint32_t vertex) const {
    return mesh_.vertices[vertex];
  }
  void Move(uint32_t vertex, const Eigen::Vector3f& position) {
    mesh_.vertices[vertex] = position;
  }

  const Facet& FacetAt(uint32_t facet) const { return mesh_.facets[facet]; }
  uint32_t From(uint32_t half) const { return FromVertex(mesh_.facets, half); }
  uint32_t To(uint32_t half) const { return ToVertex(mesh_.facets, half); }
  // The corner of its facet that a half-edge does not touch.
  uint32_t Apex(uint32_t half) const { return To(NextHalfEdge(half)); }

  // kNone at a border.
  uint32_t Partner(uint32_t half) const { return partners_[half]; }
  bool IsBorderVertex(uint32_t vertex) const {
    return partners_[outgoing_[vertex]] == kNone;
  }
  // Whether this half-edge stands for its edge: each edge has one that does.
  bool IsFirstOfEdge(uint32_t half) const {
    return !IsRemovedFacet(half / 3) &&
           (partners_[half] == kNone || half < partners_[half]);
  }

  // Calls function(half) for the half-edges that leave a vertex, one for each
  // of its facets, counter-clockwise; at a border from one end to the other.
  // \pre the vertex is not removed
  template <typename Function>
  void ForEachOutgoing(uint32_t vertex, const Function& function) const {
    const uint32_t first = outgoing_[vertex];
    uint32_t half = first;
    do {
      // Read before the function, which may change the mesh no more than
      // positions.
      const uint32_t next = partners_[PreviousHalfEdge(half)];
      function(half);
      half = next;
    } while (half != kNone && half != first);
  }

  // Calls function(neighbor) for the vertices that share an edge with a vertex.
  template <typename Function>
  void ForEachNeighbor(uint32_t vertex, const Function& function) const {
    uint32_t last = kNone;
    ForEachOutgoing(vertex, [&](uint32_t half) {
      function(To(half));
      last = half;
    });
    if (IsBorderVertex(vertex)) {
      function(Apex(last));
    }
  }

  // The number of edges at a vertex.
  int Valence(uint32_t vertex) const;

  // The facets and vertices that are left, in their order.
  MeshPart Compact() const;

  // Puts a new vertex into an edge, and cuts its facets in two. The half-edge
  // then ends at the new vertex.
  // \return the new vertex, at the edge's midpoint
  uint32_t Split(uint32_t half);

  // Whether Collapse() leaves a manifold mesh of the same topology: the link
  // condition [Dey1999].
  bool CanCollapse(uint32_t half) const;

  // Removes the vertex that a half-edge comes from, together with the edge's
  // facets; its other facets then belong to the vertex that the half-edge goes
  // to, which stays where it is.
  // \pre CanCollapse(half)
  void Collapse(uint32_t half);

  // Whether the edge has two facets, and the other diagonal of their
  // quadrilateral is not an edge yet.
  bool CanFlip(uint32_t half) const;

  // Replaces the edge by the other diagonal. The half-edge still comes from the
  // same vertex, and goes to the apex that its partner had; the diagonal is the
  // half-edge after it.
  // \pre CanFlip(half)
  void Flip(uint32_t half);

 private:
  void Join(uint32_t half, uint32_t other);
  void SetOutgoing(uint32_t half);
  bool AreNeighbors(uint32_t vertex, uint32_t other) const;

  TriangleMesh mesh_;
  std::vector<uint32_t> partners_;  // [3 F]
  std::vector<uint32_t> outgoing_;  // [V] a half-edge from each vertex, at a
                                    // border the one without partner;
                                    // kNone: the vertex is removed
};

}  // namespace colmap_ext
