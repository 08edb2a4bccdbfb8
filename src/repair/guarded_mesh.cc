#include "repair/guarded_mesh.h"

#include <algorithm>
#include <iterator>
#include <numeric>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "base/indices.h"
#include "base/union_find.h"
#include "mesh/normals.h"

namespace colmap_ext {

void DropFixedPairs(const TriangleMesh& mesh, const FixedVertices& fixed,
                    std::vector<FacetPair>* pairs) {
  std::erase_if(*pairs, [&](const FacetPair& pair) {
    return IsFixed(fixed, mesh.facets[pair[0]]) &&
           IsFixed(fixed, mesh.facets[pair[1]]);
  });
}

bool IsFoldedEdge(const TriangleMesh& mesh, uint32_t a, uint32_t b) {
  return FacetNormal(mesh, a).dot(FacetNormal(mesh, b)) < -0.5F;
}

GuardedMesh::GuardedMesh(TriangleMesh mesh, FixedVertices fixed, bool has_folds)
    : mesh_(std::move(mesh)),
      fixed_(std::move(fixed)),
      has_folds_(has_folds),
      rings_(MakeVertexRings(mesh_)),
      partners_(PairHalfEdges(mesh_.facets)),
      tree_(mesh_) {
  std::vector<FacetPair> pairs = FindSelfIntersections(mesh_, tree_);
  std::vector<uint32_t> facets(mesh_.facets.size());
  std::iota(facets.begin(), facets.end(), 0);
  FinishPairs(facets, &pairs);
  ReplacePairs({}, pairs);
}

void GuardedMesh::FinishPairs(const std::vector<uint32_t>& facets,
                              std::vector<FacetPair>* pairs) const {
  for (const uint32_t facet : facets) {
    for (uint32_t half = 3 * facet; has_folds_ && half < 3 * facet + 3;
         ++half) {
      if (IsFolded(half)) {
        const auto [low, high] = std::minmax({facet, partners_[half] / 3});
        pairs->push_back({low, high});
      }
    }
  }
  SortUnique(pairs);
  DropFixedPairs(mesh_, fixed_, pairs);
}

bool GuardedMesh::IsFolded(uint32_t half) const {
  return partners_[half] != kNone &&
         IsFoldedEdge(mesh_, half / 3, partners_[half] / 3);
}

std::vector<FacetPair> GuardedMesh::Pairs() const {
  std::vector<FacetPair> pairs;
  std::ranges::copy_if(crossing_, std::back_inserter(pairs),
                       [](const FacetPair& pair) { return pair[0] < pair[1]; });
  return pairs;
}

std::vector<FacetPair> GuardedMesh::PairsOf(
    const std::vector<uint32_t>& facets) const {
  std::vector<FacetPair> pairs;
  for (const uint32_t facet : facets) {
    for (auto pair = crossing_.lower_bound({facet, 0});
         pair != crossing_.end() && (*pair)[0] == facet; ++pair) {
      const auto [low, high] = std::minmax((*pair)[0], (*pair)[1]);
      pairs.push_back({low, high});
    }
  }
  SortUnique(&pairs);
  return pairs;
}

std::map<uint32_t, std::vector<uint32_t>> GuardedMesh::Clusters() const {
  const std::vector<FacetPair> pairs = Pairs();
  std::vector<uint32_t> facets;
  for (const FacetPair& pair : pairs) {
    Append(pair, &facets);
  }
  SortUnique(&facets);
  UnionFind groups(facets.size());
  for (const auto& [a, b] : pairs) {
    groups.Join(IndexOf(facets, a), IndexOf(facets, b));
  }
  std::unordered_map<uint32_t, uint32_t> facet_at;  // place, of a vertex
  for (uint32_t i = 0; i < facets.size(); ++i) {
    for (const uint32_t vertex : mesh_.facets[facets[i]]) {
      groups.Join(i, facet_at.try_emplace(vertex, i).first->second);
    }
  }
  std::map<uint32_t, std::vector<uint32_t>> clusters;
  for (uint32_t i = 0; i < facets.size(); ++i) {
    clusters[facets[groups.Find(i)]].push_back(facets[i]);
  }
  return clusters;
}

void GuardedMesh::ReplacePairs(const std::vector<FacetPair>& old_pairs,
                               const std::vector<FacetPair>& new_pairs) {
  for (const auto& [a, b] : old_pairs) {
    crossing_.erase({a, b});
    crossing_.erase({b, a});
  }
  for (const auto& [a, b] : new_pairs) {
    crossing_.insert({{a, b}, {b, a}});
  }
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
  FinishPairs(facets, &pairs);
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
    shape.normals.push_back(FacetNormal(mesh_, facet));
    shape.is_folded.push_back(0);
    for (uint32_t half = 3 * facet; half < 3 * facet + 3; ++half) {
      if (IsFolded(half)) {
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

std::optional<GuardedMesh::Change> GuardedMesh::Try(VertexTargets* targets) {
  Change change;
  const std::vector<uint32_t> facets = rings_.FacetsAt(targets->vertices);
  change.old_pairs = PairsOf(facets);
  const Shape shape = ShapeOf(facets);
  Swap(targets);
  if (!TurnsOver(shape, ShapeOf(facets))) {
    if (auto pairs = FewerPairs(facets, change.old_pairs)) {
      change.new_pairs = std::move(*pairs);
      return change;
    }
  }
  Swap(targets);
  return std::nullopt;
}

std::optional<size_t> GuardedMesh::PairsAfter(VertexTargets targets) {
  const std::optional<Change> change = Try(&targets);
  if (!change) {
    return std::nullopt;
  }
  Swap(&targets);
  return NumPairs() - change->old_pairs.size() + change->new_pairs.size();
}

bool GuardedMesh::Move(VertexTargets targets) {
  const std::optional<Change> change = Try(&targets);
  if (change) {
    ReplacePairs(change->old_pairs, change->new_pairs);
  }
  return change.has_value();
}

void GuardedMesh::FlipEdges(const std::vector<uint32_t>& facets) {
  std::unordered_set<uint32_t> touched;  // vertices of facets that changed
  for (const uint32_t facet : facets) {
    for (uint32_t half = 3 * facet; half < 3 * facet + 3; ++half) {
      const uint32_t partner = partners_[half];
      const auto is_touched = [&](uint32_t v) { return touched.contains(v); };
      if (std::ranges::none_of(mesh_.facets[facet], is_touched) && Flip(half)) {
        touched.insert(mesh_.facets[facet].begin(), mesh_.facets[facet].end());
        touched.insert(mesh_.facets[partner / 3].begin(),
                       mesh_.facets[partner / 3].end());
      }
    }
  }
  if (!touched.empty()) {
    rings_ = MakeVertexRings(mesh_);
    partners_ = PairHalfEdges(mesh_.facets);
  }
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
