#include "remesh/anchored_mesh.h"

#include <algorithm>
#include <bitset>

#include <tbb/parallel_for.h>

namespace colmap_ext {
namespace {

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
