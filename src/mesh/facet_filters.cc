#include "mesh/facet_filters.h"

#include <algorithm>
#include <limits>

#include "base/percentile.h"
#include "base/union_find.h"
#include "mesh/adjacency.h"

namespace colmap_ext {

std::vector<float> LongestSides(const TriangleMesh& mesh) {
  std::vector<float> sides;
  sides.reserve(mesh.facets.size());
  for (const auto& [i, j, k] : mesh.facets) {
    const auto& a = mesh.vertices[i];
    const auto& b = mesh.vertices[j];
    const auto& c = mesh.vertices[k];
    sides.push_back(std::max({(a - b).norm(), (b - c).norm(), (c - a).norm()}));
  }
  return sides;
}

double SideLimit(double factor, double percentile, std::vector<float> sides) {
  return factor <= 0 || sides.empty() ? std::numeric_limits<double>::infinity()
                                      : factor * Percentile(percentile, &sides);
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
