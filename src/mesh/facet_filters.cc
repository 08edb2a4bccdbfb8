#include "mesh/facet_filters.h"

#include <algorithm>

#include "base/percentile.h"
#include "base/union_find.h"
#include "mesh/half_edges.h"

namespace colmap_ext {
namespace {

float LongestSide(const TriangleMesh& mesh, const Facet& facet) {
  const auto& a = mesh.vertices[facet[0]];
  const auto& b = mesh.vertices[facet[1]];
  const auto& c = mesh.vertices[facet[2]];
  return std::max({(a - b).norm(), (b - c).norm(), (c - a).norm()});
}

}  // namespace

size_t DropLongFacets(double factor, double percentile, TriangleMesh* mesh) {
  if (factor <= 0 || mesh->facets.empty()) {
    return 0;
  }
  std::vector<float> sides;
  sides.reserve(mesh->facets.size());
  for (const Facet& facet : mesh->facets) {
    sides.push_back(LongestSide(*mesh, facet));
  }
  const double longest = factor * Percentile(percentile, &sides);
  return std::erase_if(mesh->facets, [&](const Facet& facet) {
    return LongestSide(*mesh, facet) > longest;
  });
}

DroppedComponents DropSmallComponents(size_t min_facets, TriangleMesh* mesh) {
  DroppedComponents dropped;
  if (min_facets <= 1) {
    return dropped;
  }
  UnionFind components(mesh->facets.size());
  ForEachEdge(SortedHalfEdges(mesh->facets), [&](auto first, auto last) {
    for (auto half = first; half != last; ++half) {
      components.Join(first->second / 3, half->second / 3);
    }
  });
  std::vector<size_t> sizes(mesh->facets.size(), 0);
  for (uint32_t i = 0; i < mesh->facets.size(); ++i) {
    ++sizes[components.Find(i)];
  }
  std::vector<Facet> kept;
  for (uint32_t i = 0; i < mesh->facets.size(); ++i) {
    const uint32_t component = components.Find(i);
    if (sizes[component] >= min_facets) {
      kept.push_back(mesh->facets[i]);
    } else {
      ++dropped.num_facets;
      dropped.num_components += component == i;
    }
  }
  mesh->facets.swap(kept);
  return dropped;
}

}  // namespace colmap_ext
