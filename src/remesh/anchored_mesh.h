#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>
#include <Eigen/Geometry>

#include "base/rows.h"
#include "mesh/editable_mesh.h"
#include "spatial/bvh.h"

namespace colmap_ext {

// The position of a vertex of the new mesh on the old surface, and the targets
// there.
struct Anchor {
  SurfacePoint source;
  Eigen::Vector3f normal{0, 0, 0};  // of the old surface, unit
  float length = 0;                 // target length of edges, scene units
  float tolerance = 0;              // distance allowed, scene units
};

// A corner of a facet that an operation would make.
struct AnchoredCorner {
  Eigen::Vector3f position;
  const Anchor* anchor;
};

using AnchoredFacet = std::array<AnchoredCorner, 3>;

// The normal, as long as twice the area, scene units squared.
inline Eigen::Vector3f AreaVector(const AnchoredFacet& facet) {
  return (facet[1].position - facet[0].position)
      .cross(facet[2].position - facet[0].position);
}

// The surface that a remeshed one approximates, with the target edge lengths.
class ReferenceSurface {
 public:
  // \param mesh  outlives this.
  // \param lengths [V] wanted at each vertex, scene units
  // \param tolerances [V] distance allowed at each vertex, scene units
  ReferenceSurface(const TriangleMesh& mesh, std::vector<float> lengths,
                   std::vector<float> tolerances);

  Anchor At(const SurfacePoint& source) const;

  // Of the nearest point whose facet faces the way `normal` does.
  // \param hint  a facet that is near.
  Anchor Nearest(const Eigen::Vector3f& position, const Eigen::Vector3f& normal,
                 uint32_t hint) const;

  Eigen::Vector3f Position(const Anchor& anchor) const {
    return ValueAt(anchor.source, mesh_, mesh_.vertices);
  }

  // Whether a facet follows the reference: its normal agrees with those at its
  // corners, or else its centre and the middles of its edges are nowhere
  // farther from a reference that faces its way than is allowed.
  bool IsFollowedBy(const AnchoredFacet& facet) const;

 private:
  struct NearPoint {
    SurfacePoint point;
    float distance;  // scene units
  };

  NearPoint NearestIn(uint32_t facet, const Eigen::Vector3f& position) const;
  NearPoint Descend(const Eigen::Vector3f& position,
                    const Eigen::Vector3f& normal, uint32_t facet) const;
  bool IsNearFacet(uint32_t facet, const Eigen::Vector3f& position,
                   const Eigen::Vector3f& normal, float tolerance) const;

  const TriangleMesh& mesh_;
  std::vector<float> lengths_;
  std::vector<float> tolerances_;
  std::vector<Eigen::Vector3f> normals_;  // [V]
  std::vector<uint32_t> partners_;        // [3 F] of half-edges
  Bvh bvh_;
};

// A mesh under work, and where each of its vertices lies on the surface that it
// started as.
struct AnchoredMesh {
  // \param lengths, tolerances [V] see ReferenceSurface
  // \pre the mesh is manifold, and outlives this
  AnchoredMesh(const TriangleMesh& mesh, std::vector<float> lengths,
               std::vector<float> tolerances, FixedVertices fixed_vertices);

  // Whether an edge is fixed.
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

  Eigen::Vector3f Middle(uint32_t half) const {
    return (edit.Position(edit.From(half)) + edit.Position(edit.To(half))) / 2;
  }

  // The point of the reference next to the edge's middle.
  Anchor AnchorOfMiddle(uint32_t half) const {
    const Anchor& from = anchors[edit.From(half)];
    return reference.Nearest(Middle(half),
                             from.normal + anchors[edit.To(half)].normal,
                             from.source.facet);
  }

  // One half-edge of each edge that key(half) has a value for, in the order of
  // these values; that of equal ones is the half-edges'.
  // \param key  uint32_t -> std::optional<float>
  template <typename Key>
  std::vector<uint32_t> EdgesBy(const Key& key) const {
    using Edge = std::pair<float, uint32_t>;
    const auto append = [&](size_t i, std::vector<Edge>* edges) {
      const auto half = static_cast<uint32_t>(i);
      const std::optional<float> value =
          edit.IsFirstOfEdge(half) ? key(half) : std::nullopt;
      if (value) {
        edges->emplace_back(*value, half);
      }
    };
    std::vector<Edge> edges =
        MakeRows<Edge>(edit.NumHalfEdges(), append).values;
    tbb::parallel_sort(edges.begin(), edges.end());
    std::vector<uint32_t> halves(edges.size());
    std::ranges::transform(edges, halves.begin(), &Edge::second);
    return halves;
  }

  AnchoredCorner Corner(uint32_t vertex) const {
    return {edit.Position(vertex), &anchors[vertex]};
  }

  // The facet of a half-edge, its corners from that which the half-edge leaves.
  AnchoredFacet Corners(uint32_t half) const {
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

  ReferenceSurface reference;
  EditableMesh edit;
  std::vector<Anchor> anchors;  // [V] of `edit`
  FixedVertices fixed;          // of `edit`
};

// The smallest of a facet's angles, as its cosine: from 1/2 to 1, the worse the
// larger; 2 where the facet has no area.
float LargestCosine(const AnchoredFacet& facet);

// Whether a facet that changes still faces the way it did, turned by no more
// than the angle of a cosine. The normal of a facet without a shape, of an
// angle below 1 degree, means nothing: then whether the facet faces the way
// that the reference does at its corners.
bool KeepsFacing(const AnchoredFacet& before, const AnchoredFacet& after,
                 float min_cosine);

// The vertices near which a mesh has changed since the last Clear().
class ChangedVertices {
 public:
  explicit ChangedVertices(size_t num_vertices) : stamps_(num_vertices, 0) {}

  void Clear() { ++stamp_; }
  void Mark(uint32_t vertex) { stamps_[vertex] = stamp_; }
  bool AnyOf(std::span<const uint32_t> vertices) const {
    return std::ranges::any_of(
        vertices, [&](uint32_t vertex) { return stamps_[vertex] == stamp_; });
  }

 private:
  std::vector<uint32_t> stamps_;  // [V]
  uint32_t stamp_ = 1;
};

// Applies operations to a mesh one after the other, as
//   for (i = 0; i < count; ++i) if (plan = propose(i)) apply(*plan);
// would, but makes many plans in parallel before the first of them is applied;
// those near which the mesh has changed since are made again.
//
// \param propose  size_t -> std::optional<Plan>; changes nothing
// \param corners  size_t -> the vertices near which nothing may change for the
//        plan to stay as it is
// \param apply  Plan -> void; marks the corners of the plans that it outdates
// \param changed  of all the mesh's vertices
// \return the number of plans applied
template <typename Propose, typename Corners, typename Apply>
size_t ApplyInOrder(size_t count, const Propose& propose,
                    const Corners& corners, const Apply& apply,
                    ChangedVertices* changed) {
  // Enough for all threads; few enough that most plans stay as they are.
  const size_t batch = std::clamp<size_t>(count / 256, 1024, 65536);
  std::vector<decltype(propose(0))> plans(batch);
  std::vector<decltype(corners(0))> vertices(batch);
  size_t num_applied = 0;
  for (size_t first = 0; first < count; first += batch) {
    const size_t size = std::min(batch, count - first);
    changed->Clear();
    tbb::parallel_for(size_t{0}, size, [&](size_t i) {
      plans[i] = propose(first + i);
      vertices[i] = corners(first + i);
    });
    for (size_t i = 0; i < size; ++i) {
      if (changed->AnyOf(vertices[i])) {
        plans[i] = propose(first + i);
      }
      if (plans[i]) {
        apply(*plans[i]);
        ++num_applied;
      }
    }
  }
  return num_applied;
}

// The steps of remeshing.

// Splits edges at their middles, the longest first, as long as any is more than
// `max_ratio` times as long as is wanted.
void SplitLongEdges(float max_ratio, AnchoredMesh* mesh);

// Collapses edges, the shortest first, that are less than `min_ratio` times as
// long as is wanted, where this makes no edge longer than `max_ratio` times
// what is wanted, turns no facet over and keeps to the reference. The vertices
// of a border stay on it.
void CollapseShortEdges(float min_ratio, float max_ratio, AnchoredMesh* mesh);

// Collapses the shortest edges of needles, facets with an angle of less than 15
// degrees, whatever their length, under the same conditions.
void CollapseNeedles(float max_ratio, AnchoredMesh* mesh);

// Flips edges where this brings the numbers of edges at their four vertices
// closer to 6 (4 at a border), and keeps to the reference [Botsch2004].
void FlipForValence(AnchoredMesh* mesh);

// Flips edges where this makes the smallest angle of their two facets larger,
// and keeps to the reference.
// \param min_cosine  of that angle, in [0, 1]: edges of facets with better ones
//        stay.
void FlipForAngles(float min_cosine, AnchoredMesh* mesh);

// Moves each vertex within the reference towards the centroid of the facets
// around it, so that their sizes become those that are wanted [Botsch2004];
// half as far, and then not at all, where a facet would turn over, become worse
// than thin, or leave the reference. Vertices of a border stay.
// \param is_chosen [V] which ones move; empty: all.
void RelaxVertices(const std::vector<uint8_t>& is_chosen, AnchoredMesh* mesh);

}  // namespace colmap_ext
