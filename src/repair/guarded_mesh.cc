#include "repair/guarded_mesh.h"

#include <algorithm>
#include <utility>

#include "mesh/facet_normals.h"
#include "mesh/half_edges.h"

namespace colmap_ext {
namespace {

constexpr float kFoldedCosine = -0.5F;  // between normals: 120 degrees

void SortUnique(std::vector<uint32_t>* values) {
  std::sort(values->begin(), values->end());
  values->erase(std::unique(values->begin(), values->end()), values->end());
}

}  // namespace

void DropFixedPairs(const TriangleMesh& mesh, const FixedVertices& fixed,
                    std::vector<FacetPair>* pairs) {
  if (!fixed.empty()) {
    std::erase_if(*pairs, [&](const FacetPair& pair) {
      return IsFixed(fixed, mesh.facets[pair[0]]) &&
             IsFixed(fixed, mesh.facets[pair[1]]);
    });
  }
}

GuardedMesh::GuardedMesh(TriangleMesh mesh, FixedVertices fixed)
    : mesh_(std::move(mesh)), fixed_(std::move(fixed)), tree_(mesh_) {
  Update();
  std::vector<FacetPair> pairs = FindSelfIntersections(mesh_, tree_);
  DropFixedPairs(mesh_, fixed_, &pairs);
  ReplacePairs({}, pairs);
}

void GuardedMesh::Update() {
  rings_ = MakeVertexRings(mesh_);
  partners_ = PairHalfEdges(mesh_.facets);
}

std::vector<FacetPair> GuardedMesh::Pairs() const {
  std::vector<FacetPair> pairs;
  for (const auto& [facet, others] : crossing_) {
    for (auto other = others.lower_bound(facet); other != others.end();
         ++other) {
      pairs.push_back({facet, *other});
    }
  }
  return pairs;
}

std::vector<uint32_t> GuardedMesh::FacetsOf(
    const std::vector<uint32_t>& vertices) const {
  std::vector<uint32_t> facets;
  for (const uint32_t vertex : vertices) {
    for (const uint32_t corner : rings_.corners[vertex]) {
      facets.push_back(corner / 3);
    }
  }
  SortUnique(&facets);
  return facets;
}

std::vector<FacetPair> GuardedMesh::PairsOf(
    const std::vector<uint32_t>& facets) const {
  std::vector<FacetPair> pairs;
  for (const uint32_t facet : facets) {
    const auto row = crossing_.find(facet);
    if (row != crossing_.end()) {
      for (const uint32_t other : row->second) {
        pairs.push_back({std::min(facet, other), std::max(facet, other)});
      }
    }
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

void GuardedMesh::ReplacePairs(const std::vector<FacetPair>& old_pairs,
                               const std::vector<FacetPair>& new_pairs) {
  const auto erase = [&](uint32_t facet, uint32_t other) {
    const auto row = crossing_.find(facet);
    if (row != crossing_.end() && row->second.erase(other) > 0 &&
        row->second.empty()) {
      crossing_.erase(row);
    }
  };
  for (const auto& [a, b] : old_pairs) {
    erase(a, b);
    erase(b, a);
  }
  for (const auto& [a, b] : new_pairs) {
    crossing_[a].insert(b);
    crossing_[b].insert(a);
  }
  num_pairs_ += new_pairs.size();
  num_pairs_ -= old_pairs.size();
}

void GuardedMesh::Swap(VertexTargets* targets) {
  for (size_t i = 0; i < targets->vertices.size(); ++i) {
    std::swap(mesh_.vertices[targets->vertices[i]], targets->positions[i]);
  }
}

std::optional<std::vector<FacetPair>> GuardedMesh::FewerPairs(
    const std::vector<uint32_t>& facets,
    const std::vector<FacetPair>& old_pairs) {
  tree_.Extend(mesh_, facets);
  std::vector<FacetPair> pairs = FindSelfIntersections(mesh_, tree_, facets);
  DropFixedPairs(mesh_, fixed_, &pairs);
  work_ += facets.size() + pairs.size();
  if (pairs.size() < old_pairs.size() &&
      std::includes(old_pairs.begin(), old_pairs.end(), pairs.begin(),
                    pairs.end())) {
    return pairs;
  }
  return std::nullopt;
}

GuardedMesh::Shape GuardedMesh::ShapeOf(
    const std::vector<uint32_t>& facets) const {
  Shape shape;
  for (const uint32_t facet : facets) {
    const Eigen::Vector3f normal = FacetNormal(mesh_, facet);
    shape.normals.push_back(normal);
    shape.is_folded.push_back(0);
    for (uint32_t half = 3 * facet; half < 3 * facet + 3; ++half) {
      if (partners_[half] != kNone &&
          normal.dot(FacetNormal(mesh_, partners_[half] / 3)) < kFoldedCosine) {
        shape.is_folded.back() = 1;
        // An edge between two of the facets counts twice, before and after.
        ++shape.num_folded_edges;
      }
    }
  }
  return shape;
}

bool GuardedMesh::TurnsOver(const Shape& before, const Shape& after) {
  for (size_t i = 0; i < before.normals.size(); ++i) {
    const bool unfolds = before.is_folded[i] != 0 && after.is_folded[i] == 0;
    if (before.normals[i].dot(after.normals[i]) < 0 && !unfolds) {
      return true;
    }
  }
  return after.num_folded_edges > before.num_folded_edges;
}

std::optional<GuardedMesh::Change> GuardedMesh::Try(VertexTargets targets) {
  Change change;
  const std::vector<uint32_t> facets = FacetsOf(targets.vertices);
  change.old_pairs = PairsOf(facets);
  const Shape shape = ShapeOf(facets);
  Swap(&targets);
  if (!TurnsOver(shape, ShapeOf(facets))) {
    if (auto pairs = FewerPairs(facets, change.old_pairs)) {
      change.new_pairs = std::move(*pairs);
      return change;
    }
  }
  Swap(&targets);
  return std::nullopt;
}

std::optional<size_t> GuardedMesh::PairsAfter(const VertexTargets& targets) {
  VertexTargets old = targets;
  for (size_t i = 0; i < old.vertices.size(); ++i) {
    old.positions[i] = mesh_.vertices[old.vertices[i]];
  }
  const std::optional<Change> change = Try(targets);
  if (!change) {
    return std::nullopt;
  }
  Swap(&old);
  return num_pairs_ - change->old_pairs.size() + change->new_pairs.size();
}

bool GuardedMesh::Move(const VertexTargets& targets) {
  const std::optional<Change> change = Try(targets);
  if (change) {
    ReplacePairs(change->old_pairs, change->new_pairs);
  }
  return change.has_value();
}

bool GuardedMesh::Flip(uint32_t half) {
  const uint32_t partner = partners_[half];
  if (partner == kNone) {
    return false;
  }
  const uint32_t first = half / 3, second = partner / 3;
  const Facet old_first = mesh_.facets[first];
  const Facet old_second = mesh_.facets[second];
  const uint32_t from = FromVertex(mesh_.facets, half);
  const uint32_t to = ToVertex(mesh_.facets, half);
  const uint32_t left = ToVertex(mesh_.facets, NextHalfEdge(half));
  const uint32_t right = ToVertex(mesh_.facets, NextHalfEdge(partner));
  const auto ring = rings_.neighbors[left];
  const bool is_fixed = IsFixed(fixed_, from) && IsFixed(fixed_, to);
  if (is_fixed || left == right ||
      std::binary_search(ring.begin(), ring.end(), right)) {
    return false;
  }
  const std::vector<uint32_t> facets = {std::min(first, second),
                                        std::max(first, second)};
  const std::vector<FacetPair> old_pairs = PairsOf(facets);
  const Eigen::Vector3f a = FacetNormal(mesh_, first);
  const Eigen::Vector3f b = FacetNormal(mesh_, second);
  mesh_.facets[first] = {left, from, right};
  mesh_.facets[second] = {right, to, left};
  const auto agrees = [&](uint32_t facet) {
    const Eigen::Vector3f normal = FacetNormal(mesh_, facet);
    return normal.dot(a) > 0 && normal.dot(b) > 0;
  };
  if (agrees(first) && agrees(second)) {
    if (const auto pairs = FewerPairs(facets, old_pairs)) {
      ReplacePairs(old_pairs, *pairs);
      return true;
    }
  }
  mesh_.facets[first] = old_first;
  mesh_.facets[second] = old_second;
  return false;
}

}  // namespace colmap_ext
