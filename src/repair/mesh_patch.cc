#include "repair/mesh_patch.h"

#include <algorithm>
#include <unordered_map>
#include <utility>

#include <tbb/parallel_for.h>

#include "base/indices.h"
#include "base/union_find.h"
#include "mesh/adjacency.h"
#include "spatial/box_tree.h"
#include "spatial/facet_tree.h"

namespace colmap_ext {

MeshPart TakePatch(const TriangleMesh& mesh, std::vector<uint32_t> facets) {
  MeshPart patch{{}, VerticesOf(mesh, facets), std::move(facets)};
  for (const uint32_t vertex : patch.vertices) {
    patch.mesh.vertices.push_back(mesh.vertices[vertex]);
  }
  for (const uint32_t i : patch.facets) {
    Facet& facet = patch.mesh.facets.emplace_back(mesh.facets[i]);
    for (uint32_t& vertex : facet) {
      vertex = static_cast<uint32_t>(
          std::ranges::lower_bound(patch.vertices, vertex) -
          patch.vertices.begin());
    }
  }
  return patch;
}

std::vector<uint8_t> MarkAround(const TriangleMesh& mesh,
                                const std::vector<uint32_t>& facets,
                                int num_rings) {
  std::vector<uint8_t> is_reached(mesh.vertices.size(), 0);
  for (const uint32_t vertex : VerticesOf(mesh, facets)) {
    is_reached[vertex] = 1;
  }
  const auto mark = [&] {
    std::vector<uint8_t> is_marked(mesh.facets.size());
    tbb::parallel_for(size_t{0}, is_marked.size(), [&](size_t i) {
      const auto& [a, b, c] = mesh.facets[i];
      is_marked[i] = is_reached[a] | is_reached[b] | is_reached[c];
    });
    return is_marked;
  };
  std::vector<uint8_t> is_marked = mark();
  for (int ring = 0; ring < num_rings; ++ring) {
    for (size_t i = 0; i < is_marked.size(); ++i) {
      for (const uint32_t vertex : mesh.facets[i]) {
        is_reached[vertex] |= is_marked[i];
      }
    }
    is_marked = mark();
  }
  return is_marked;
}

void MarkWithin(const TriangleMesh& mesh,
                const std::vector<Eigen::AlignedBox3f>& boxes,
                std::vector<uint8_t>* is_marked) {
  const BoxTree tree(boxes);
  tbb::parallel_for(
      uint32_t{0}, static_cast<uint32_t>(mesh.facets.size()), [&](uint32_t i) {
        const Eigen::AlignedBox3f box = BoxOf(mesh, i);
        if (tree.Search([&](const auto& b) { return b.intersects(box); },
                        [](uint32_t) { return true; })) {
          (*is_marked)[i] = 1;
        }
      });
}

std::vector<std::vector<uint32_t>> CrossingClusters(
    const TriangleMesh& mesh, const std::vector<FacetPair>& pairs) {
  std::vector<uint32_t> facets;
  for (const FacetPair& pair : pairs) {
    facets.insert(facets.end(), pair.begin(), pair.end());
  }
  SortUnique(&facets);
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

}  // namespace colmap_ext
