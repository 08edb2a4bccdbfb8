#include "mesh/facet_filters.h"

#include <algorithm>
#include <limits>

#include "base/percentile.h"
#include "base/union_find.h"
#include "mesh/half_edges.h"

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

DroppedComponents DropSmallComponents(size_t min_facets, TriangleMesh* mesh,
                                      std::vector<uint32_t>* facet_sources) {
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
  std::vector<uint32_t> kept_sources;
  for (uint32_t i = 0; i < mesh->facets.size(); ++i) {
    const uint32_t component = components.Find(i);
    if (sizes[component] >= min_facets) {
      kept.push_back(mesh->facets[i]);
      kept_sources.push_back((*facet_sources)[i]);
    } else {
      ++dropped.num_facets;
      dropped.num_components += component == i;
    }
  }
  mesh->facets.swap(kept);
  facet_sources->swap(kept_sources);
  return dropped;
}

}  // namespace colmap_ext
