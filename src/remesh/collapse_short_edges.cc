#include "remesh/collapse_short_edges.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace colmap_ext {
namespace {

using Eigen::Vector3f;

// Where the vertex that stands for an edge would be.
struct Place {
  Vector3f position;
  Anchor anchor;
};

float DistanceToSegment(const Vector3f& p, const Vector3f& a,
                        const Vector3f& b) {
  const float length_squared = (b - a).squaredNorm();
  const float t =
      length_squared > 0
          ? std::clamp((p - a).dot(b - a) / length_squared, 0.0F, 1.0F)
          : 0;
  return (a + t * (b - a) - p).norm();
}

class Collapser {
 public:
  Collapser(const ReferenceSurface& reference, float max_ratio,
            AnchoredMesh* mesh)
      : reference_(reference), max_ratio_(max_ratio), mesh_(mesh) {}

  bool Collapse(uint32_t half) {
    EditableMesh& edit = mesh_->edit;
    // A vertex of a border takes in one from the inside.
    if (edit.IsBorderVertex(edit.From(half)) &&
        !edit.IsBorderVertex(edit.To(half))) {
      half = edit.Partner(half);
    }
    if (!edit.CanCollapse(half)) {
      return false;
    }
    const uint32_t from = edit.From(half);
    const uint32_t to = edit.To(half);
    if (!edit.IsBorderVertex(to)) {
      return CollapseToMiddle(half) || CollapseTo(half, PlaceOf(to)) ||
             CollapseTo(half, PlaceOf(from));
    }
    if (!edit.IsBorderVertex(from)) {
      return CollapseTo(half, PlaceOf(to));
    }
    return (IsStraight(from, to) && CollapseTo(half, PlaceOf(to))) ||
           (IsStraight(to, from) && CollapseTo(half, PlaceOf(from)));
  }

 private:
  Place PlaceOf(uint32_t vertex) const {
    return {mesh_->edit.Position(vertex), mesh_->anchors[vertex]};
  }

  // To the point of the reference next to the edge's middle.
  bool CollapseToMiddle(uint32_t half) {
    const uint32_t from = mesh_->edit.From(half);
    const uint32_t to = mesh_->edit.To(half);
    const Anchor& anchor = mesh_->anchors[from];
    const Vector3f middle =
        (mesh_->edit.Position(from) + mesh_->edit.Position(to)) / 2;
    // Most are refused here, before anything is looked up.
    if (!KeepsShape(half, {middle, anchor})) {
      return false;
    }
    const Anchor nearest = reference_.Nearest(
        middle, anchor.normal + mesh_->anchors[to].normal, anchor.source.facet);
    return CollapseTo(half, {reference_.Position(nearest), nearest});
  }

  bool CollapseTo(uint32_t half, const Place& place) {
    if (!KeepsShape(half, place) || !FollowsReference(half, place)) {
      return false;
    }
    const uint32_t to = mesh_->edit.To(half);
    mesh_->edit.Collapse(half);
    mesh_->edit.Move(to, place.position);
    mesh_->anchors[to] = place.anchor;
    return true;
  }

  // Whether a border hardly moves when a vertex of it is merged into its
  // neighbor.
  bool IsStraight(uint32_t vertex, uint32_t neighbor) const {
    const EditableMesh& edit = mesh_->edit;
    uint32_t other = vertex;
    uint32_t last = kNoHalfEdge;
    edit.ForEachOutgoing(vertex, [&](uint32_t half) {
      other = last == kNoHalfEdge ? edit.To(half) : other;
      last = half;
    });
    if (other == neighbor) {
      other = edit.Apex(last);
    }
    return DistanceToSegment(edit.Position(vertex), edit.Position(other),
                             edit.Position(neighbor)) <
           mesh_->anchors[vertex].tolerance;
  }

  // Whether all facets that would get the place as a corner pass a test.
  // \param test  of the half-edge that leaves the corner.
  template <typename Test>
  bool AllChangedFacets(uint32_t half, const Test& test) const {
    const EditableMesh& edit = mesh_->edit;
    const uint32_t ends[] = {edit.From(half), edit.To(half)};
    bool pass = true;
    for (int k = 0; k < 2; ++k) {
      const uint32_t other = ends[1 - k];
      edit.ForEachOutgoing(ends[k], [&](uint32_t outgoing) {
        pass = pass && (edit.To(outgoing) == other ||
                        edit.Apex(outgoing) == other || test(outgoing));
      });
    }
    return pass;
  }

  // Whether no edge gets too long, and no facet turns over or is next to it.
  bool KeepsShape(uint32_t half, const Place& place) const {
    constexpr float kMinCosine = 0.2F;
    return AllChangedFacets(half, [&](uint32_t outgoing) {
      const auto facet = mesh_->Corners(outgoing);
      for (int k = 1; k < 3; ++k) {
        const float wanted =
            (place.anchor.length + facet[k].anchor->length) / 2;
        if ((facet[k].position - place.position).norm() > max_ratio_ * wanted) {
          return false;
        }
      }
      std::array<AnchoredCorner, 3> after = facet;
      after[0] = {place.position, &place.anchor};
      return KeepsFacing(facet, after, kMinCosine);
    });
  }

  bool FollowsReference(uint32_t half, const Place& place) const {
    return AllChangedFacets(half, [&](uint32_t outgoing) {
      std::array<AnchoredCorner, 3> facet = mesh_->Corners(outgoing);
      facet[0] = {place.position, &place.anchor};
      return reference_.IsFollowedBy(facet);
    });
  }

  const ReferenceSurface& reference_;
  float max_ratio_;
  AnchoredMesh* mesh_;
};

// The edges that are too short, the shortest first.
std::vector<uint32_t> ShortEdges(const AnchoredMesh& mesh, float min_ratio) {
  return mesh.EdgesBy([&](uint32_t half) -> std::optional<float> {
    const float ratio = mesh.RelativeLength(half);
    return ratio < min_ratio ? std::optional(ratio) : std::nullopt;
  });
}

}  // namespace

size_t CollapseShortEdges(const ReferenceSurface& reference, float min_ratio,
                          float max_ratio, AnchoredMesh* mesh) {
  Collapser collapser(reference, max_ratio, mesh);
  constexpr int kMaxRounds = 2;  // later ones find next to nothing
  size_t num_collapses = 0;
  for (int round = 0; round < kMaxRounds; ++round) {
    size_t num_in_round = 0;
    for (const uint32_t half : ShortEdges(*mesh, min_ratio)) {
      if (!mesh->edit.IsRemovedFacet(half / 3) &&
          mesh->RelativeLength(half) < min_ratio) {
        num_in_round += collapser.Collapse(half) ? 1 : 0;
      }
    }
    num_collapses += num_in_round;
    if (num_in_round == 0) {
      break;
    }
  }
  return num_collapses;
}

size_t CollapseNeedles(const ReferenceSurface& reference, float max_ratio,
                       AnchoredMesh* mesh) {
  constexpr float kMaxCosine = 0.966F;  // 15 degrees
  Collapser collapser(reference, max_ratio, mesh);
  const EditableMesh& edit = mesh->edit;
  size_t num_collapses = 0;
  for (uint32_t facet = 0; facet < edit.NumFacets(); ++facet) {
    if (edit.IsRemovedFacet(facet) ||
        LargestCosine(mesh->Corners(3 * facet)) <= kMaxCosine) {
      continue;
    }
    uint32_t shortest = 3 * facet;
    for (uint32_t half = 3 * facet + 1; half < 3 * facet + 3; ++half) {
      if (mesh->Length(half) < mesh->Length(shortest)) {
        shortest = half;
      }
    }
    num_collapses += collapser.Collapse(shortest) ? 1 : 0;
  }
  return num_collapses;
}

}  // namespace colmap_ext
