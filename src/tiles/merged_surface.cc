#include "tiles/merged_surface.h"

#include <algorithm>
#include <unordered_map>
#include <utility>

#include "mesh/adjacency.h"

namespace colmap_ext {
namespace {

// Numbers the vertices that are used.
// \return [V] the plan's vertex of each, ascending
std::vector<uint32_t> NumberVertices(std::vector<Facet>* facets) {
  std::vector<uint32_t> ids;
  ids.reserve(3 * facets->size());
  for (const Facet& facet : *facets) {
    ids.insert(ids.end(), facet.begin(), facet.end());
  }
  std::ranges::sort(ids);
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  ids.shrink_to_fit();
  for (Facet& facet : *facets) {
    for (uint32_t& vertex : facet) {
      vertex = static_cast<uint32_t>(std::ranges::lower_bound(ids, vertex) -
                                     ids.begin());
    }
  }
  return ids;
}

class FixedPartners {
 public:
  FixedPartners(const std::vector<uint32_t>& ids, ExtractedSurface* surface)
      : ids_(ids), facets_(surface->mesh.facets), surface_(*surface) {}

  void Apply(const std::vector<PartnerFix>& fixes) {
    FindPlaces(fixes);
    for (const PartnerFix& fix : fixes) {
      const uint32_t half = HalfEdgeAt(fix.facet, fix.from, fix.to);
      if (half != kNone) {
        surface_.partners[half] =
            fix.has_partner ? HalfEdgeAt(fix.partner, fix.to, fix.from) : kNone;
      }
    }
  }

 private:
  void FindPlaces(const std::vector<PartnerFix>& fixes) {
    std::vector<uint8_t> is_asked_for(ids_.size(), 0);
    for (const PartnerFix& fix : fixes) {
      for (const FacetKey& facet : {fix.facet, fix.partner}) {
        places_[facet] = kNone;
        for (const uint32_t id : facet) {
          const auto at = std::ranges::lower_bound(ids_, id);
          if (at != ids_.end()) {
            is_asked_for[static_cast<size_t>(at - ids_.begin())] = 1;
          }
        }
      }
    }
    for (uint32_t i = 0; i < facets_.size(); ++i) {
      const auto& [a, b, c] = facets_[i];
      if (is_asked_for[a] == 0 || is_asked_for[b] == 0 ||
          is_asked_for[c] == 0) {
        continue;
      }
      const auto found =
          places_.find(Sorted(FacetKey{ids_[a], ids_[b], ids_[c]}));
      if (found != places_.end()) {
        found->second = i;
      }
    }
  }

  // kNone of a facet that is not there.
  uint32_t HalfEdgeAt(const FacetKey& facet, uint32_t from, uint32_t to) const {
    const uint32_t place = places_.at(facet);
    for (uint32_t half = 3 * place; place != kNone && half < 3 * place + 3;
         ++half) {
      if (ids_[FromVertex(facets_, half)] == from &&
          ids_[ToVertex(facets_, half)] == to) {
        return half;
      }
    }
    return kNone;
  }

  const std::vector<uint32_t>& ids_;
  const std::vector<Facet>& facets_;
  ExtractedSurface& surface_;
  std::unordered_map<FacetKey, uint32_t, KeyHash> places_;
};

}  // namespace

TileSurface SurfaceOf(const LabeledParts& parts, uint32_t tile) {
  const TilePart part = parts.Read(tile);
  const std::vector<uint32_t>& ids = part.tile.ids;
  const ExtractedSurface extracted =
      ExtractSurface(part.tile.tetrahedra, part.labels);
  const std::vector<Facet>& local = extracted.mesh.facets;
  const auto facet_of = [&](uint32_t i) {
    return Facet{ids[local[i][0]], ids[local[i][1]], ids[local[i][2]]};
  };
  TileSurface surface;
  for (uint32_t i = 0; i < local.size(); ++i) {
    const Facet facet = facet_of(i);
    if (parts.TileOf(std::ranges::min(facet)) == tile) {
      surface.facets.push_back(facet);
    }
  }
  const std::vector<uint32_t> simple = PairHalfEdges(local);
  for (uint32_t half = 0; half < simple.size(); ++half) {
    const uint32_t partner = extracted.partners[half];
    const uint32_t from = ids[FromVertex(local, half)];
    const uint32_t to = ids[ToVertex(local, half)];
    if (partner == simple[half] || parts.TileOf(std::min(from, to)) != tile) {
      continue;
    }
    const bool has_partner = partner != kNone;
    surface.fixes.push_back(
        {Sorted(facet_of(half / 3)), from, to, has_partner,
         has_partner ? Sorted(facet_of(partner / 3)) : FacetKey{}});
  }
  return surface;
}

std::vector<Eigen::Vector3f> PositionsOf(
    const PlanVertices& plan, const std::vector<Eigen::Vector3f>& centroids,
    const std::vector<uint32_t>& ids) {
  const uint32_t num_vertices = plan.Blocks().NumVertices();
  const auto first_centroid = std::ranges::lower_bound(ids, num_vertices);
  std::vector<Eigen::Vector3f> positions =
      PositionsOf(plan, std::vector<uint32_t>(ids.begin(), first_centroid));
  for (auto id = first_centroid; id != ids.end(); ++id) {
    positions.push_back(centroids[*id - num_vertices]);
  }
  return positions;
}

MergedSurface MergeSurface(const PlanVertices& plan, const LabeledParts& parts,
                           const std::vector<Eigen::Vector3f>& centroids) {
  MergedSurface merged;
  std::vector<Facet>& facets = merged.extracted.mesh.facets;
  std::vector<PartnerFix> fixes;
  for (uint32_t tile = 0; tile < plan.Blocks().NumTiles(); ++tile) {
    const TileSurface surface = SurfaceOf(parts, tile);
    facets.insert(facets.end(), surface.facets.begin(), surface.facets.end());
    fixes.insert(fixes.end(), surface.fixes.begin(), surface.fixes.end());
  }
  merged.ids = NumberVertices(&facets);
  merged.extracted.partners = PairHalfEdges(facets);
  FixedPartners(merged.ids, &merged.extracted).Apply(fixes);
  merged.extracted.mesh.vertices = PositionsOf(plan, centroids, merged.ids);
  return merged;
}

}  // namespace colmap_ext
