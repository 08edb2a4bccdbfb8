#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "mesh/fixed_vertices.h"
#include "mesh/triangle_mesh.h"
#include "remesh/editable_mesh.h"
#include "remesh/reference_surface.h"

namespace colmap_ext {

// A mesh under work, and where each of its vertices lies on the surface that it
// started as.
struct AnchoredMesh {
  // \pre the mesh is that of the reference, and manifold
  AnchoredMesh(const TriangleMesh& mesh, const ReferenceSurface& reference,
               FixedVertices fixed_vertices = {});

  // Whether an edge has to stay.
  bool IsFixedEdge(uint32_t half) const {
    return IsFixed(fixed, edit.From(half)) && IsFixed(fixed, edit.To(half));
  }

  float Length(uint32_t half) const {
    return (edit.Position(edit.To(half)) - edit.Position(edit.From(half)))
        .norm();
  }

  // The length of an edge over that which is wanted there.
  float RelativeLength(uint32_t half) const {
    return 2 * Length(half) /
           (anchors[edit.From(half)].length + anchors[edit.To(half)].length);
  }

  // One half-edge of each edge that key(half) has a value for, in the order of
  // these values; that of equal ones is the half-edges'.
  // \param key  uint32_t -> std::optional<float>
  template <typename Key>
  std::vector<uint32_t> EdgesBy(const Key& key) const {
    std::vector<std::pair<float, uint32_t>> edges;
    for (uint32_t half = 0; half < edit.NumHalfEdges(); ++half) {
      if (edit.IsFirstOfEdge(half)) {
        if (const std::optional<float> value = key(half)) {
          edges.emplace_back(*value, half);
        }
      }
    }
    std::sort(edges.begin(), edges.end());
    std::vector<uint32_t> halves;
    halves.reserve(edges.size());
    for (const auto& edge : edges) {
      halves.push_back(edge.second);
    }
    return halves;
  }

  AnchoredCorner Corner(uint32_t vertex) const {
    return {edit.Position(vertex), &anchors[vertex]};
  }

  // The facet of a half-edge, its corners from that which the half-edge leaves.
  std::array<AnchoredCorner, 3> Corners(uint32_t half) const {
    return {Corner(edit.From(half)), Corner(edit.To(half)),
            Corner(edit.Apex(half))};
  }

  // The corners of the facets on both sides of an edge, some of them twice
  // where there is one facet: what an operation on the edge looks at, together
  // with the facets around them.
  std::array<uint32_t, 4> CornersAround(uint32_t half) const {
    const uint32_t apex = edit.Apex(half);
    const uint32_t partner = edit.Partner(half);
    return {edit.From(half), edit.To(half), apex,
            partner == kNone ? apex : edit.Apex(partner)};
  }

  EditableMesh edit;
  std::vector<Anchor> anchors;  // [V] of `edit`
  FixedVertices fixed;          // of `edit`
};

// The smallest of a facet's angles, as its cosine: from 1/2 to 1, the worse the
// larger; 2 where the facet has no area.
float LargestCosine(const Eigen::Vector3f& a, const Eigen::Vector3f& b,
                    const Eigen::Vector3f& c);
float LargestCosine(const std::array<AnchoredCorner, 3>& facet);

// Whether a facet that changes still faces the way it did, turned by no more
// than the angle of a cosine. The normal of a facet without a shape, of an
// angle below 1 degree, means nothing: then whether the facet faces the way
// that the reference does at its corners.
bool KeepsFacing(const std::array<AnchoredCorner, 3>& before,
                 const std::array<AnchoredCorner, 3>& after, float min_cosine);

}  // namespace colmap_ext
