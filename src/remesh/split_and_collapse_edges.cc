#include "remesh/anchored_mesh.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include <tbb/parallel_for.h>

namespace colmap_ext {
namespace {

// \param edges  half-edges; those that are short enough by then stay
void Split(float max_ratio, const std::vector<uint32_t>& edges,
           AnchoredMesh* mesh) {
  const auto ends_of = [mesh](uint32_t half) {
    return std::pair(mesh->edit.From(half), mesh->edit.To(half));
  };
  // Found in parallel from the ends, which do not move.
  std::vector<std::pair<uint32_t, uint32_t>> ends(edges.size());
  std::vector<Anchor> anchors(edges.size());
  tbb::parallel_for(size_t{0}, edges.size(), [&](size_t i) {
    ends[i] = ends_of(edges[i]);
    anchors[i] = mesh->AnchorOfMiddle(edges[i]);
  });
  for (size_t i = 0; i < edges.size(); ++i) {
    const uint32_t half = edges[i];
    if (mesh->RelativeLength(half) > max_ratio) {  // else it was split before
      mesh->anchors.push_back(
          ends[i] == ends_of(half) ? anchors[i] : mesh->AnchorOfMiddle(half));
      mesh->edit.Split(half);
    }
  }
}

using Eigen::Vector3f;

// Where the vertex that stands for an edge would be.
struct Place {
  Vector3f position;
  Anchor anchor;
};

// An edge, and where it collapses to.
struct CollapsePlan {
  uint32_t half;
  Place place;
};

class Collapser {
 public:
  Collapser(float max_ratio, AnchoredMesh* mesh)
      : max_ratio_(max_ratio),
        mesh_(mesh),
        changed_(mesh->edit.NumVertices()) {}

  // Collapses one edge after the other, where that may be done.
  // \param edge_of  size_t -> uint32_t, a half-edge
  // \param is_chosen  size_t -> bool, by the facets at the edge
  // \return how many
  template <typename EdgeOf, typename IsChosen>
  size_t Collapse(size_t count, const EdgeOf& edge_of,
                  const IsChosen& is_chosen) {
    return ApplyInOrder(
        count,
        [&](size_t i) {
          return is_chosen(i) ? Plan(edge_of(i)) : std::nullopt;
        },
        [&](size_t i) { return mesh_->CornersAround(edge_of(i)); },
        [&](const CollapsePlan& plan) { Apply(plan); }, &changed_);
  }

 private:
  Place PlaceOf(uint32_t vertex) const {
    return {mesh_->edit.Position(vertex), mesh_->anchors[vertex]};
  }

  std::optional<CollapsePlan> Plan(uint32_t half) const {
    const EditableMesh& edit = mesh_->edit;
    // An inner vertex is merged into one on a border, and any vertex into a
    // fixed one.
    if ((edit.IsBorderVertex(edit.From(half)) ||
         IsFixed(mesh_->fixed, edit.From(half))) &&
        !edit.IsBorderVertex(edit.To(half))) {
      half = edit.Partner(half);
    }
    if (IsFixed(mesh_->fixed, edit.From(half)) || !edit.CanCollapse(half)) {
      return std::nullopt;
    }
    for (const std::optional<Place>& place : PlacesFor(half)) {
      if (place && MayCollapse(half, *place)) {
        return CollapsePlan{half, *place};
      }
    }
    return std::nullopt;
  }

  // In the order in which they are tried.
  std::array<std::optional<Place>, 3> PlacesFor(uint32_t half) const {
    const uint32_t from = mesh_->edit.From(half);
    const uint32_t to = mesh_->edit.To(half);
    const bool is_to_fixed = IsFixed(mesh_->fixed, to);
    std::array<std::optional<Place>, 3> places;
    if (mesh_->edit.IsBorderVertex(to)) {
      const bool is_border_edge = mesh_->edit.IsBorderVertex(from);
      if (!is_border_edge || IsStraight(from, to)) {
        places[0] = PlaceOf(to);
      }
      if (is_border_edge && !is_to_fixed && IsStraight(to, from)) {
        places[1] = PlaceOf(from);
      }
    } else if (is_to_fixed) {
      places[0] = PlaceOf(to);
    } else {
      places = {MiddlePlace(half), PlaceOf(to), PlaceOf(from)};
    }
    return places;
  }

  // The point of the reference next to the edge's middle.
  std::optional<Place> MiddlePlace(uint32_t half) const {
    // Most are refused here, before anything is looked up.
    if (!KeepsShape(half, {mesh_->Middle(half),
                           mesh_->anchors[mesh_->edit.From(half)]})) {
      return std::nullopt;
    }
    const Anchor nearest = mesh_->AnchorOfMiddle(half);
    return Place{mesh_->reference.Position(nearest), nearest};
  }

  bool MayCollapse(uint32_t half, const Place& place) const {
    return KeepsShape(half, place) && FollowsReference(half, place);
  }

  // Outdates the plans for edges at a vertex next to the ends.
  void Apply(const CollapsePlan& plan) {
    EditableMesh& edit = mesh_->edit;
    const uint32_t to = edit.To(plan.half);
    for (const uint32_t end : {edit.From(plan.half), to}) {
      changed_.Mark(end);
      edit.ForEachNeighbor(end,
                           [&](uint32_t neighbor) { changed_.Mark(neighbor); });
    }
    edit.Collapse(plan.half);
    edit.Move(to, plan.place.position);
    mesh_->anchors[to] = plan.place.anchor;
  }

  // Whether a border hardly moves when a vertex of it is merged into its
  // neighbor.
  bool IsStraight(uint32_t vertex, uint32_t neighbor) const {
    const EditableMesh& edit = mesh_->edit;
    uint32_t other = vertex;
    uint32_t last = kNone;
    edit.ForEachOutgoing(vertex, [&](uint32_t half) {
      other = last == kNone ? edit.To(half) : other;
      last = half;
    });
    if (other == neighbor) {
      other = edit.Apex(last);
    }
    const Vector3f& p = edit.Position(vertex);
    const Vector3f& a = edit.Position(other);
    const Vector3f& b = edit.Position(neighbor);
    return (a + NearestOnSegment(a, b, p) * (b - a) - p).norm() <
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
      AnchoredFacet after = facet;
      after[0] = {place.position, &place.anchor};
      return KeepsFacing(facet, after, kMinCosine);
    });
  }

  bool FollowsReference(uint32_t half, const Place& place) const {
    return AllChangedFacets(half, [&](uint32_t outgoing) {
      AnchoredFacet facet = mesh_->Corners(outgoing);
      facet[0] = {place.position, &place.anchor};
      return mesh_->reference.IsFollowedBy(facet);
    });
  }

  float max_ratio_;
  AnchoredMesh* mesh_;
  ChangedVertices changed_;
};

}  // namespace

void SplitLongEdges(float max_ratio, AnchoredMesh* mesh) {
  // Each round halves the longest edges: enough for one of 65536 lengths.
  constexpr int kMaxRounds = 16;
  const auto is_long = [&](uint32_t half) -> std::optional<float> {
    const float ratio = mesh->RelativeLength(half);
    return ratio > max_ratio && !mesh->IsFixedEdge(half) ? std::optional(-ratio)
                                                         : std::nullopt;
  };
  for (int round = 0; round < kMaxRounds; ++round) {
    const std::vector<uint32_t> edges = mesh->EdgesBy(is_long);
    if (edges.empty()) {
      return;
    }
    Split(max_ratio, edges, mesh);
  }
}

void CollapseShortEdges(float min_ratio, float max_ratio, AnchoredMesh* mesh) {
  Collapser collapser(max_ratio, mesh);
  const auto is_short = [&](uint32_t half) -> std::optional<float> {
    const float ratio = mesh->RelativeLength(half);
    return ratio < min_ratio ? std::optional(ratio) : std::nullopt;
  };
  constexpr int kMaxRounds = 2;  // later ones find next to nothing
  for (int round = 0; round < kMaxRounds; ++round) {
    const std::vector<uint32_t> edges = mesh->EdgesBy(is_short);
    const auto edge_of = [&](size_t i) { return edges[i]; };
    if (collapser.Collapse(edges.size(), edge_of, [&](size_t i) {
          return !mesh->edit.IsRemovedFacet(edges[i] / 3) && is_short(edges[i]);
        }) == 0) {
      return;
    }
  }
}

void CollapseNeedles(float max_ratio, AnchoredMesh* mesh) {
  constexpr float kMaxCosine = 0.966F;  // 15 degrees
  const EditableMesh& edit = mesh->edit;
  const auto shortest_edge = [&](size_t i) {
    const auto first = static_cast<uint32_t>(3 * i);
    return std::min({first, first + 1, first + 2}, [&](uint32_t a, uint32_t b) {
      return mesh->Length(a) < mesh->Length(b);
    });
  };
  Collapser(max_ratio, mesh)
      .Collapse(edit.NumFacets(), shortest_edge, [&](size_t i) {
        const auto facet = static_cast<uint32_t>(i);
        return !edit.IsRemovedFacet(facet) &&
               LargestCosine(mesh->Corners(3 * facet)) > kMaxCosine;
      });
}

}  // namespace colmap_ext
