#include "repair/guarded_mesh.h"

#include <algorithm>
#include <iterator>
#include <unordered_map>
#include <utility>

#include "base/indices.h"
#include "base/rows.h"
#include "base/union_find.h"
#include "mesh/normals.h"

namespace colmap_ext {
namespace {

bool IsFoldedHalfEdge(const TriangleMesh& mesh,
                      const std::vector<uint32_t>& partners, uint32_t half) {
  return partners[half] != kNone &&
         IsFoldedEdge(mesh, half / 3, partners[half] / 3);
}

}  // namespace

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

std::vector<FacetPair> FoldsOf(const TriangleMesh& mesh,
                               const std::vector<uint32_t>& partners,
                               const std::vector<uint32_t>& facets) {
  const auto append = [&](size_t i, std::vector<FacetPair>* folds) {
    const uint32_t facet = facets[i];
    for (uint32_t half = 3 * facet; half < 3 * facet + 3; ++half) {
      if (IsFoldedHalfEdge(mesh, partners, half)) {
        const auto [low, high] = std::minmax({facet, partners[half] / 3});
        folds->push_back({low, high});
      }
    }
  };
  auto folds = MakeRows<FacetPair>(facets.size(), append).values;
  SortUnique(&folds);
  return folds;
}

GuardedMesh::GuardedMesh(TriangleMesh mesh, FixedVertices fixed, bool has_folds)
    : mesh_(std::move(mesh)),
      fixed_(std::move(fixed)),
      has_folds_(has_folds),
      rings_(MakeVertexRings(mesh_)),
      partners_(PairHalfEdges(mesh_.facets)),
      tree_(mesh_) {
  std::vector<FacetPair> pairs = FindSelfIntersections(mesh_, tree_);
  FinishPairs(Iota(mesh_.facets.size()), &pairs);
  ReplacePairs({}, pairs);
}

void GuardedMesh::FinishPairs(const std::vector<uint32_t>& facets,
                              std::vector<FacetPair>* pairs) const {
  if (has_folds_) {
    Append(FoldsOf(mesh_, partners_, facets), pairs);
  }
  SortUnique(pairs);
  DropFixedPairs(mesh_, fixed_, pairs);
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
      if (IsFoldedHalfEdge(mesh_, partners_, half)) {
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

bool GuardedMesh::Move(VertexTargets targets) {
  const std::vector<uint32_t> facets = rings_.FacetsAt(targets.vertices);
  const std::vector<FacetPair> old_pairs = PairsOf(facets);
  const Shape shape = ShapeOf(facets);
  Swap(&targets);
  if (!TurnsOver(shape, ShapeOf(facets))) {
    if (const auto pairs = FewerPairs(facets, old_pairs)) {
      ReplacePairs(old_pairs, *pairs);
      return true;
    }
  }
  Swap(&targets);
  return false;
}

}  // namespace colmap_ext
