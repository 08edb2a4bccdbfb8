#include "remesh/anchored_mesh.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "remesh/speculation.h"

namespace colmap_ext {
namespace {

// The corners of the two facets at an edge: from, to, the apex of the
// half-edge, that of its partner.
struct Quad {
  std::array<uint32_t, 4> vertices;
  std::array<AnchoredCorner, 4> corners;
};

Quad QuadOf(const AnchoredMesh& mesh, uint32_t half) {
  const std::array<uint32_t, 4> vertices = mesh.CornersAround(half);
  return {vertices,
          {mesh.Corner(vertices[0]), mesh.Corner(vertices[1]),
           mesh.Corner(vertices[2]), mesh.Corner(vertices[3])}};
}

// The worst angles, as their cosines, of the two facets before and after.
std::pair<float, float> WorstAngles(const Quad& quad) {
  const auto& [a, b, c, d] = quad.corners;
  return {std::max(LargestCosine({a, b, c}), LargestCosine({b, a, d})),
          std::max(LargestCosine({a, d, c}), LargestCosine({b, c, d}))};
}

// Whether the facets after the flip face like those before, and keep to the
// reference.
bool MayFlip(const ReferenceSurface& reference, const Quad& quad) {
  const auto& [from, to, apex, other] = quad.corners;
  const AnchoredFacet before[] = {{from, to, apex}, {to, from, other}};
  const AnchoredFacet after[] = {{from, other, apex}, {to, apex, other}};
  constexpr float kMinCosine = 0.5F;  // none turns by more than 60 degrees
  for (const AnchoredFacet& old_facet : before) {
    for (const AnchoredFacet& new_facet : after) {
      if (!KeepsFacing(old_facet, new_facet, kMinCosine)) {
        return false;
      }
    }
  }
  return reference.IsFollowedBy(after[0]) && reference.IsFollowedBy(after[1]);
}

// Flips the edges for which is_better(quad) holds, one after the other, where
// they may.
// \param is_better  Quad -> bool
// \param on_flip    Quad -> void, before each flip
// \return how many
template <typename IsBetter, typename OnFlip>
size_t FlipEdges(const IsBetter& is_better, const OnFlip& on_flip,
                 AnchoredMesh* mesh) {
  EditableMesh& edit = mesh->edit;
  const auto propose = [&](size_t i) -> std::optional<uint32_t> {
    const auto half = static_cast<uint32_t>(i);
    if (!edit.IsFirstOfEdge(half) || edit.Partner(half) == kNone ||
        mesh->IsFixedEdge(half)) {
      return std::nullopt;
    }
    const Quad quad = QuadOf(*mesh, half);
    return is_better(quad) && edit.CanFlip(half) &&
                   MayFlip(mesh->reference, quad)
               ? std::optional(half)
               : std::nullopt;
  };
  ChangedVertices changed(edit.NumVertices());
  const auto flip = [&](uint32_t half) {
    const Quad quad = QuadOf(*mesh, half);
    on_flip(quad);
    edit.Flip(half);
    for (const uint32_t vertex : quad.vertices) {
      changed.Mark(vertex);
    }
  };
  return ApplyInOrder(
      edit.NumHalfEdges(), propose,
      [&](size_t half) {
        return mesh->CornersAround(static_cast<uint32_t>(half));
      },
      flip, &changed);
}

}  // namespace

void FlipForValence(AnchoredMesh* mesh) {
  const EditableMesh& edit = mesh->edit;
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
  constexpr std::array<int, 4> kChange = {-1, -1, 1, 1};
  const auto is_better = [&](const Quad& quad) {
    int gain = 0;
    for (int k = 0; k < 4; ++k) {
      const int now = excess[quad.vertices[k]];
      const int then = now + kChange[k];
      gain += now * now - then * then;
    }
    if (gain <= 0) {
      return false;
    }
    const auto [before, after] = WorstAngles(quad);
    return after < std::max(kMaxCosine, before);
  };
  const auto on_flip = [&](const Quad& quad) {
    for (int k = 0; k < 4; ++k) {
      excess[quad.vertices[k]] += kChange[k];
    }
  };
  FlipEdges(is_better, on_flip, mesh);
}

void FlipForAngles(float min_cosine, AnchoredMesh* mesh) {
  constexpr int kMaxRounds = 4;      // later ones find next to nothing
  constexpr float kMinGain = 1e-3F;  // of the cosine, so that rounding does
                                     // not flip edges back and forth
  const auto is_better = [&](const Quad& quad) {
    const auto [before, after] = WorstAngles(quad);
    return before >= min_cosine && after < before - kMinGain;
  };
  const auto on_flip = [](const Quad& /*quad*/) {};
  for (int round = 0;
       round < kMaxRounds && FlipEdges(is_better, on_flip, mesh) > 0; ++round) {
  }
}

}  // namespace colmap_ext
