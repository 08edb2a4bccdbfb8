#include "remesh/flip_edges.h"

#include <algorithm>
#include <array>
#include <cstdint>

namespace colmap_ext {
namespace {

using Eigen::Vector3f;

// The corners of the two facets at an edge: from, to, the apex of the
// half-edge, that of its partner.
struct Quad {
  std::array<uint32_t, 4> vertices;
  std::array<AnchoredCorner, 4> corners;
};

Quad QuadOf(const AnchoredMesh& mesh, uint32_t half) {
  const EditableMesh& edit = mesh.edit;
  const std::array<uint32_t, 4> vertices = {edit.From(half), edit.To(half),
                                            edit.Apex(half),
                                            edit.Apex(edit.Partner(half))};
  return {vertices,
          {mesh.Corner(vertices[0]), mesh.Corner(vertices[1]),
           mesh.Corner(vertices[2]), mesh.Corner(vertices[3])}};
}

// Of the two facets before and after, the worst angle.
struct Angles {
  float before = 0;
  float after = 0;
};

Angles WorstAngles(const Quad& quad) {
  const auto& [from, to, apex, other] = quad.corners;
  const Vector3f& a = from.position;
  const Vector3f& b = to.position;
  const Vector3f& c = apex.position;
  const Vector3f& d = other.position;
  return {std::max(LargestCosine(a, b, c), LargestCosine(b, a, d)),
          std::max(LargestCosine(a, d, c), LargestCosine(b, c, d))};
}

// Whether the facets after the flip face like those before, and keep to the
// reference.
bool MayFlip(const ReferenceSurface& reference, const Quad& quad) {
  const auto& [from, to, apex, other] = quad.corners;
  using Corners = std::array<AnchoredCorner, 3>;
  const Corners before[] = {{from, to, apex}, {to, from, other}};
  const Corners after[] = {{from, other, apex}, {to, apex, other}};
  constexpr float kMinCosine = 0.5F;  // none turns by more than 60 degrees
  for (const Corners& old_facet : before) {
    for (const Corners& new_facet : after) {
      if (!KeepsFacing(old_facet, new_facet, kMinCosine)) {
        return false;
      }
    }
  }
  return reference.IsFollowedBy({from, other, apex}) &&
         reference.IsFollowedBy({to, apex, other});
}

}  // namespace

size_t FlipForValence(const ReferenceSurface& reference, AnchoredMesh* mesh) {
  EditableMesh& edit = mesh->edit;
  // How many edges more than wanted each vertex has.
  std::vector<int> excess(edit.NumVertices(), 0);
  for (uint32_t vertex = 0; vertex < excess.size(); ++vertex) {
    if (!edit.IsRemovedVertex(vertex)) {
      excess[vertex] =
          edit.Valence(vertex) - (edit.IsBorderVertex(vertex) ? 4 : 6);
    }
  }
  // Facets whose angles get smaller than 20 degrees are not worth it.
  constexpr float kMaxCosine = 0.94F;
  size_t num_flips = 0;
  for (uint32_t half = 0; half < edit.NumHalfEdges(); ++half) {
    if (!edit.IsFirstOfEdge(half) || !edit.CanFlip(half)) {
      continue;
    }
    const Quad quad = QuadOf(*mesh, half);
    constexpr std::array<int, 4> kChange = {-1, -1, 1, 1};
    int gain = 0;
    for (int k = 0; k < 4; ++k) {
      const int now = excess[quad.vertices[k]];
      const int then = now + kChange[k];
      gain += now * now - then * then;
    }
    if (gain <= 0) {
      continue;
    }
    const Angles angles = WorstAngles(quad);
    if (angles.after < std::max(kMaxCosine, angles.before) &&
        MayFlip(reference, quad)) {
      edit.Flip(half);
      ++num_flips;
      for (int k = 0; k < 4; ++k) {
        excess[quad.vertices[k]] += kChange[k];
      }
    }
  }
  return num_flips;
}

size_t FlipForAngles(const ReferenceSurface& reference, float min_cosine,
                     AnchoredMesh* mesh) {
  EditableMesh& edit = mesh->edit;
  constexpr int kMaxRounds = 4;      // later ones find next to nothing
  constexpr float kMinGain = 1e-3F;  // of the cosine, so that rounding does
                                     // not flip edges back and forth
  size_t num_flips = 0;
  for (int round = 0; round < kMaxRounds; ++round) {
    size_t num_in_round = 0;
    for (uint32_t half = 0; half < edit.NumHalfEdges(); ++half) {
      if (!edit.IsFirstOfEdge(half) || edit.Partner(half) == kNoHalfEdge) {
        continue;
      }
      const Quad quad = QuadOf(*mesh, half);
      const Angles angles = WorstAngles(quad);
      if (angles.before >= min_cosine &&
          angles.after < angles.before - kMinGain && edit.CanFlip(half) &&
          MayFlip(reference, quad)) {
        edit.Flip(half);
        ++num_in_round;
      }
    }
    num_flips += num_in_round;
    if (num_in_round == 0) {
      break;
    }
  }
  return num_flips;
}

}  // namespace colmap_ext
