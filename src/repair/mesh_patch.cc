#include "repair/mesh_patch.h"

#include <algorithm>

#include <tbb/parallel_for.h>

#include "spatial/box_tree.h"
#include "spatial/facet_tree.h"

namespace colmap_ext {

MeshPatch TakePatch(const TriangleMesh& mesh,
                    const std::vector<uint8_t>& is_chosen) {
  MeshPatch patch;
  for (uint32_t i = 0; i < is_chosen.size(); ++i) {
    if (is_chosen[i] != 0) {
      patch.facets.push_back(i);
      patch.vertices.insert(patch.vertices.end(), mesh.facets[i].begin(),
                            mesh.facets[i].end());
    }
  }
  std::ranges::sort(patch.vertices);
  patch.vertices.erase(
      std::unique(patch.vertices.begin(), patch.vertices.end()),
      patch.vertices.end());
  for (const uint32_t vertex : patch.vertices) {
    patch.mesh.vertices.push_back(mesh.vertices[vertex]);
  }
  for (const uint32_t i : patch.facets) {
    Facet facet = mesh.facets[i];
    for (uint32_t& vertex : facet) {
      vertex = static_cast<uint32_t>(
          std::ranges::lower_bound(patch.vertices, vertex) -
          patch.vertices.begin());
    }
    patch.mesh.facets.push_back(facet);
  }
  return patch;
}

std::vector<uint8_t> MarkAround(const TriangleMesh& mesh,
                                const std::vector<uint32_t>& facets,
                                int num_rings) {
  std::vector<uint8_t> is_reached(mesh.vertices.size(), 0);
  for (const uint32_t i : facets) {
    for (const uint32_t vertex : mesh.facets[i]) {
      is_reached[vertex] = 1;
    }
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

}  // namespace colmap_ext
