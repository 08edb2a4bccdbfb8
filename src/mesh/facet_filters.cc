#include "mesh/facet_filters.h"

#include <algorithm>

#include "base/percentile.h"
#include "base/union_find.h"
#include "mesh/adjacency.h"

namespace colmap_ext {

size_t DropLongFacets(double factor, double percentile, TriangleMesh* mesh) {
  if (factor <= 0 || mesh->facets.empty()) {
    return 0;
  }
  const auto longest_side = [mesh](const Facet& facet) {
    const auto [a, b, c] = CornersOf(*mesh, facet);
    return std::max({(a - b).norm(), (b - c).norm(), (c - a).norm()});
  };
  std::vector<float> sides(mesh->facets.size());
  std::ranges::transform(mesh->facets, sides.begin(), longest_side);
  const double limit = factor * Percentile(percentile, &sides);
  return std::erase_if(mesh->facets, [&](const Facet& facet) {
    return !(longest_side(facet) <= limit);
  });
}

DroppedComponents DropSmallComponents(size_t min_facets,
                                      std::vector<Facet>* facets) {
  DroppedComponents dropped;
  if (min_facets <= 1) {
    return dropped;
  }
  UnionFind components(facets->size());
  ForEachEdge(*facets, [&](auto first, auto last) {
    for (auto half = first; half != last; ++half) {
      components.Join(first->second / 3, half->second / 3);
    }
  });
  std::vector<uint32_t> sizes(facets->size(), 0);
  for (uint32_t i = 0; i < facets->size(); ++i) {
    ++sizes[components.Find(i)];
  }
  size_t num_kept = 0;
  for (uint32_t i = 0; i < sizes.size(); ++i) {
    const uint32_t component = components.Find(i);
    if (sizes[component] >= min_facets) {
      (*facets)[num_kept++] = (*facets)[i];
    } else {
      ++dropped.num_facets;
      dropped.num_components += component == i;
    }
  }
  facets->resize(num_kept);
  return dropped;
}

}  // namespace colmap_ext
