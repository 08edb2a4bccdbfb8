#include "spatial/self_intersections.h"

#include <algorithm>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "spatial/facet_intersection.h"
#include "spatial/orientation.h"

namespace colmap_ext {
namespace {

using Pairs = std::vector<FacetPair>;
using PairsOfThreads = tbb::enumerable_thread_specific<Pairs>;

// Sorted, each once.
Pairs Collect(const PairsOfThreads& parts) {
  Pairs pairs;
  for (const Pairs& part : parts) {
    pairs.insert(pairs.end(), part.begin(), part.end());
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

void AddIfIntersecting(const TriangleMesh& mesh, uint32_t a, uint32_t b,
                       Pairs* pairs) {
  const FacetPair pair{std::min(a, b), std::max(a, b)};
  if (DoesPairIntersect(mesh, pair)) {
    pairs->push_back(pair);
  }
}

}  // namespace

bool DoesPairIntersect(const TriangleMesh& mesh, const FacetPair& pair) {
  if (pair[0] == pair[1]) {
    const auto& [a, b, c] = mesh.facets[pair[0]];
    return AreCollinear(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]);
  }
  return FacetsIntersect(mesh.vertices, mesh.facets[pair[0]],
                         mesh.facets[pair[1]]);
}

std::vector<FacetPair> FindSelfIntersections(const TriangleMesh& mesh) {
  return FindSelfIntersections(mesh, FacetTree(mesh));
}

std::vector<FacetPair> FindSelfIntersections(const TriangleMesh& mesh,
                                             const FacetTree& tree) {
  const auto num_facets = static_cast<uint32_t>(mesh.facets.size());
  PairsOfThreads found;
  tbb::parallel_for(size_t{0}, tree.NumLeaves(), [&](size_t leaf) {
    tree.ForEachPair(leaf, [&](uint32_t a, uint32_t b) {
      AddIfIntersecting(mesh, a, b, &found.local());
    });
  });
  tbb::parallel_for(uint32_t{0}, num_facets, [&](uint32_t facet) {
    AddIfIntersecting(mesh, facet, facet, &found.local());
  });
  return Collect(found);
}

std::vector<FacetPair> FindSelfIntersections(
    const TriangleMesh& mesh, const FacetTree& tree,
    const std::vector<uint32_t>& facets) {
  PairsOfThreads found;
  tbb::parallel_for(size_t{0}, facets.size(), [&](size_t i) {
    const uint32_t facet = facets[i];
    tree.ForEachNear(BoxOf(mesh, facet), [&](uint32_t other) {
      AddIfIntersecting(mesh, facet, other, &found.local());
    });
  });
  return Collect(found);
}

}  // namespace colmap_ext
