#include "remesh/anchored_mesh.h"

#include <algorithm>
#include <array>
#include <bitset>
#include <optional>
#include <utility>

#include <tbb/parallel_for.h>

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

using Eigen::Vector3f;

// The centroid of the facets around a vertex, weighted by their areas in units
// of the area that is wanted there.
Vector3f CenterAround(const AnchoredMesh& mesh, uint32_t vertex) {
  Vector3f sum = Vector3f::Zero();
  float total = 0;
  mesh.edit.ForEachOutgoing(vertex, [&](uint32_t half) {
    const auto facet = mesh.Corners(half);
    const Vector3f& a = facet[0].position;
    const Vector3f& b = facet[1].position;
    const Vector3f& c = facet[2].position;
    const float length = facet[0].anchor->length + facet[1].anchor->length +
                         facet[2].anchor->length;
    const float weight = AreaVector(facet).norm() / (length * length);
    sum += weight * (a + b + c) / 3;
    total += weight;
  });
  return total > 0 ? Vector3f(sum / total) : mesh.edit.Position(vertex);
}

// Where a vertex would go: that far towards the centre, along the surface.
Anchor Target(const AnchoredMesh& mesh, uint32_t vertex, float share) {
  const Vector3f& position = mesh.edit.Position(vertex);
  const Anchor& anchor = mesh.anchors[vertex];
  Vector3f motion = share * (CenterAround(mesh, vertex) - position);
  motion -= motion.dot(anchor.normal) * anchor.normal;
  return mesh.reference.Nearest(position + motion, anchor.normal,
                                anchor.source.facet);
}

// Whether the facets around a vertex keep their quality if it moves.
bool MayMove(const AnchoredMesh& mesh, uint32_t vertex,
             const AnchoredCorner& target) {
  constexpr float kMinTurn = 0.5F;      // 60 degrees
  constexpr float kMaxCosine = 0.966F;  // 15 degrees
  bool may_move = true;
  mesh.edit.ForEachOutgoing(vertex, [&](uint32_t half) {
    if (!may_move) {
      return;
    }
    const AnchoredFacet before = mesh.Corners(half);
    const AnchoredFacet after = {target, before[1], before[2]};
    const float before_cosine = LargestCosine(before);
    may_move = KeepsFacing(before, after, kMinTurn) &&
               LargestCosine(after) < std::max(before_cosine, kMaxCosine) &&
               mesh.reference.IsFollowedBy(after);
  });
  return may_move;
}

// The vertices in groups without neighbors, ascending: each is in the first
// group that none of its neighbors before it is in. One that finds none of 64
// is left out.
std::vector<std::vector<uint32_t>> IndependentGroups(
    const EditableMesh& mesh, const std::vector<uint32_t>& vertices) {
  constexpr size_t kMaxGroups = 64;
  std::vector<uint8_t> group_of(mesh.NumVertices(), kMaxGroups);
  std::vector<std::vector<uint32_t>> groups;
  for (const uint32_t vertex : vertices) {
    std::bitset<kMaxGroups + 1> is_taken;
    mesh.ForEachNeighbor(
        vertex, [&](uint32_t neighbor) { is_taken.set(group_of[neighbor]); });
    size_t group = 0;
    while (group < kMaxGroups && is_taken[group]) {
      ++group;
    }
    if (group < kMaxGroups) {
      group_of[vertex] = static_cast<uint8_t>(group);
      groups.resize(std::max(groups.size(), group + 1));
      groups[group].push_back(vertex);
    }
  }
  return groups;
}

}  // namespace

void FlipForValence(AnchoredMesh* mesh) {
  const EditableMesh& edit = mesh->edit;
  // How many edges more than wanted each vertex has.
  std::vector<int> excess(edit.NumVertices(), 0);
  tbb::parallel_for(size_t{0}, excess.size(), [&](size_t i) {
    const auto vertex = static_cast<uint32_t>(i);
    if (!edit.IsRemovedVertex(vertex)) {
      excess[vertex] =
          edit.Valence(vertex) - (edit.IsBorderVertex(vertex) ? 4 : 6);
    }
  });
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

void RelaxVertices(const std::vector<uint8_t>& is_chosen, AnchoredMesh* mesh) {
  EditableMesh& edit = mesh->edit;
  std::vector<uint32_t> vertices;  // that may move
  for (uint32_t vertex = 0; vertex < edit.NumVertices(); ++vertex) {
    if (!edit.IsRemovedVertex(vertex) && !edit.IsBorderVertex(vertex) &&
        !IsFixed(mesh->fixed, vertex) &&
        (is_chosen.empty() || is_chosen[vertex] != 0)) {
      vertices.push_back(vertex);
    }
  }
  const auto groups = IndependentGroups(edit, vertices);
  std::vector<Anchor> targets(edit.NumVertices());
  for (const float share : {1.0F, 0.5F}) {
    // All targets are found from the same mesh; whether the facets allow them
    // is then asked group by group.
    tbb::parallel_for(size_t{0}, vertices.size(), [&](size_t i) {
      targets[vertices[i]] = Target(*mesh, vertices[i], share);
    });
    for (const std::vector<uint32_t>& group : groups) {
      tbb::parallel_for(size_t{0}, group.size(), [&](size_t i) {
        const uint32_t vertex = group[i];
        const Vector3f position = mesh->reference.Position(targets[vertex]);
        if (MayMove(*mesh, vertex, {position, &targets[vertex]})) {
          edit.Move(vertex, position);
          mesh->anchors[vertex] = targets[vertex];
        }
      });
    }
  }
}

}  // namespace colmap_ext
