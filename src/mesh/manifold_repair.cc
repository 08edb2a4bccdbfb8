#include "mesh/manifold_repair.h"

#include <algorithm>
#include <utility>

#include <tbb/parallel_sort.h>

#include "mesh/fan_split.h"
#include "mesh/half_edges.h"

namespace colmap_ext {

namespace {

bool IsValid(const TriangleMesh& mesh, const Facet& facet) {
  return std::all_of(facet.begin(), facet.end(), [&mesh](uint32_t vertex) {
    return vertex < mesh.vertices.size() && mesh.vertices[vertex].allFinite();
  });
}

bool IsDegenerate(const Facet& facet) {
  return facet[0] == facet[1] || facet[1] == facet[2] || facet[2] == facet[0];
}

// [F] whether a facet before has the same three vertices.
std::vector<uint8_t> FindRepeated(const std::vector<Facet>& facets) {
  std::vector<std::pair<Facet, uint32_t>> sorted(facets.size());
  for (uint32_t i = 0; i < facets.size(); ++i) {
    sorted[i] = {facets[i], i};
    std::sort(sorted[i].first.begin(), sorted[i].first.end());
  }
  tbb::parallel_sort(sorted.begin(), sorted.end());
  std::vector<uint8_t> is_repeated(facets.size(), 0);
  for (size_t i = 1; i < sorted.size(); ++i) {
    is_repeated[sorted[i].second] = sorted[i].first == sorted[i - 1].first;
  }
  return is_repeated;
}

size_t CountUnused(const TriangleMesh& mesh) {
  std::vector<uint8_t> is_used(mesh.vertices.size(), 0);
  for (const Facet& facet : mesh.facets) {
    for (const uint32_t vertex : facet) {
      is_used[vertex] = 1;
    }
  }
  return static_cast<size_t>(std::count(is_used.begin(), is_used.end(), 0));
}

}  // namespace

ManifoldRepair RepairManifold(const TriangleMesh& mesh) {
  ManifoldRepair repair;
  TriangleMesh sound{mesh.vertices, {}};
  for (const Facet& facet : mesh.facets) {
    if (!IsValid(mesh, facet)) {
      ++repair.num_invalid_facets;
    } else if (IsDegenerate(facet)) {
      ++repair.num_degenerate_facets;
    } else {
      sound.facets.push_back(facet);
    }
  }
  const std::vector<uint8_t> is_repeated = FindRepeated(sound.facets);
  size_t num_kept = 0;
  for (size_t i = 0; i < sound.facets.size(); ++i) {
    if (is_repeated[i] == 0) {
      sound.facets[num_kept++] = sound.facets[i];
    }
  }
  repair.num_duplicate_facets = sound.facets.size() - num_kept;
  sound.facets.resize(num_kept);
  repair.num_unused_vertices = CountUnused(sound);
  std::vector<uint32_t> partners = PairHalfEdges(sound.facets);
  FanSplit split = SplitFans(std::move(sound), std::move(partners));
  repair.mesh = std::move(split.mesh);
  repair.sources = std::move(split.sources);
  repair.num_split_vertices = split.num_split_vertices;
  repair.num_midpoints = split.num_midpoints;
  return repair;
}

}  // namespace colmap_ext
