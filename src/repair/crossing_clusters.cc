#include "repair/crossing_clusters.h"

#include <algorithm>
#include <map>
#include <unordered_map>
#include <unordered_set>

#include "base/union_find.h"

namespace colmap_ext {

std::vector<std::vector<uint32_t>> CrossingClusters(
    const TriangleMesh& mesh, const std::vector<FacetPair>& pairs) {
  std::vector<uint32_t> facets;
  for (const FacetPair& pair : pairs) {
    facets.insert(facets.end(), pair.begin(), pair.end());
  }
  std::sort(facets.begin(), facets.end());
  facets.erase(std::unique(facets.begin(), facets.end()), facets.end());
  const auto place = [&](uint32_t facet) {
    return static_cast<uint32_t>(
        std::lower_bound(facets.begin(), facets.end(), facet) - facets.begin());
  };
  UnionFind groups(facets.size());
  for (const auto& [a, b] : pairs) {
    groups.Join(place(a), place(b));
  }
  std::unordered_map<uint32_t, uint32_t> facet_at;  // place, of a vertex
  for (uint32_t i = 0; i < facets.size(); ++i) {
    for (const uint32_t vertex : mesh.facets[facets[i]]) {
      groups.Join(i, facet_at.try_emplace(vertex, i).first->second);
    }
  }
  std::vector<std::vector<uint32_t>> clusters;
  std::unordered_map<uint32_t, size_t> cluster_of;  // by a group's root
  for (uint32_t i = 0; i < facets.size(); ++i) {
    const size_t cluster =
        cluster_of.try_emplace(groups.Find(i), clusters.size()).first->second;
    if (cluster == clusters.size()) {
      clusters.emplace_back();
    }
    clusters[cluster].push_back(facets[i]);
  }
  return clusters;
}

std::vector<uint32_t> VerticesAround(const TriangleMesh& mesh,
                                     const VertexRings& rings,
                                     const std::vector<uint32_t>& facets,
                                     int num_rings) {
  std::unordered_set<uint32_t> found;
  std::vector<uint32_t> vertices;
  const auto add = [&](uint32_t vertex) {
    if (found.insert(vertex).second) {
      vertices.push_back(vertex);
    }
  };
  for (const uint32_t facet : facets) {
    for (const uint32_t vertex : mesh.facets[facet]) {
      add(vertex);
    }
  }
  size_t first = 0;
  for (int ring = 0; ring < num_rings; ++ring) {
    const size_t last = vertices.size();
    for (; first < last; ++first) {
      for (const uint32_t neighbor : rings.neighbors[vertices[first]]) {
        add(neighbor);
      }
    }
  }
  std::sort(vertices.begin(), vertices.end());
  return vertices;
}

}  // namespace colmap_ext
