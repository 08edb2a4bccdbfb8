#include <utility>
#include <vector>

#include "mesh/adjacency.h"
#include "mesh/split_fans.h"
#include "repair/borders.h"
#include "repair/guarded_mesh.h"
#include "repair/self_intersection_repair.h"

namespace colmap_ext {
namespace {

// Chosen by hand. More pairs mean surfaces that pass through each other. A hole
// that cannot be closed after dropping so many rings stays open.
constexpr size_t kMaxReplacedPairs = 256;
constexpr int kMaxReplacedRings = 2;

// Drops pairs of facets and the rings around them, and closes the holes.
// \param was_border [V]
// \param from  gets where the surface comes from
// \return the number of holes that are left
size_t Replace(const std::vector<FacetPair>& pairs, int num_rings,
               const std::vector<uint8_t>& was_border, Surface* surface,
               Provenance* from) {
  const FixedVertices fixed = FixedOf(surface->fixed_sources);
  const std::vector<uint8_t> is_dropped =
      MarkAround(surface->mesh, pairs, num_rings);
  TriangleMesh kept{surface->mesh.vertices, {}};
  from->facets.clear();
  for (uint32_t i = 0; i < is_dropped.size(); ++i) {
    const Facet& facet = surface->mesh.facets[i];
    if (is_dropped[i] == 0 || IsFixed(fixed, facet[0]) ||
        IsFixed(fixed, facet[1]) || IsFixed(fixed, facet[2])) {
      kept.facets.push_back(facet);
      from->facets.push_back(i);
    }
  }
  FanSplit split = SplitFans(std::move(kept));
  *from = Compose(*from, split.from);
  std::vector<uint8_t> is_new;
  for (const auto& [vertex, same] : split.from.vertices) {
    is_new.push_back(was_border[vertex] == 0 ? 1 : 0);
  }
  surface->Become(std::move(split));
  const HoleReport report = CloseNewHoles(is_new, surface);
  from->vertices.resize(surface->mesh.vertices.size(), {kNone, kNone});
  from->facets.resize(surface->mesh.facets.size(), kNone);
  return report.NumLeft();
}

Provenance ReplaceIntersecting(const std::vector<FacetPair>& pairs,
                               Surface* surface) {
  const Provenance identity = IdentityOf(surface->mesh);
  const std::vector<uint8_t> was_border =
      MakeVertexRings(surface->mesh).is_border;
  std::pair<Surface, Provenance> best;
  size_t num_holes = 1;
  for (int num_rings = 0; num_rings <= kMaxReplacedRings && num_holes > 0;
       ++num_rings) {
    std::pair<Surface, Provenance> replaced(*surface, identity);
    num_holes = Replace(pairs, num_rings, was_border, &replaced.first,
                        &replaced.second);
    if (num_rings == 0 || num_holes == 0) {
      best = std::move(replaced);
    }
  }
  *surface = std::move(best.first);
  return std::move(best.second);
}

}  // namespace

Provenance FinishRepair(size_t* num_pairs, Surface* surface) {
  Provenance from = IdentityOf(surface->mesh);
  const auto find_pairs = [surface] {
    std::vector<FacetPair> pairs = FindSelfIntersections(surface->mesh);
    DropFixedPairs(surface->mesh, FixedOf(surface->fixed_sources), &pairs);
    return pairs;
  };
  if (*num_pairs > 0 && *num_pairs <= kMaxReplacedPairs) {
    if (const std::vector<FacetPair> pairs = find_pairs(); !pairs.empty()) {
      from = ReplaceIntersecting(pairs, surface);
    }
    *num_pairs = find_pairs().size();
  }
  return from;
}

}  // namespace colmap_ext
