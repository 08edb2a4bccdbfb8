#include "tiles/merged_surface.h"

#include <algorithm>
#include <span>
#include <stdexcept>
#include <unordered_map>

#include "mesh/half_edges.h"
#include "tiles/cell_key.h"

namespace colmap_ext {
namespace {

// The partner of a half-edge that two facets at its edge alone do not tell.
struct PartnerFix {
  FacetKey facet;
  uint32_t from;
  uint32_t to;
  bool has_partner;
  FacetKey partner;
};

// A part of all cells, and whose facets and edges are taken from it.
struct Source {
  const Tetrahedralization& tetrahedra;
  const std::vector<uint8_t>& labels;
  const std::vector<uint32_t>& ids;
};

// Collects facets by the plan's vertices.
class SurfaceCollector {
 public:
  // \param is_ours  vertices of a facet or an edge, ascending -> whether it is
  //        taken from this source
  template <typename IsOurs>
  void Add(const Source& source, const IsOurs& is_ours) {
    const ExtractedSurface surface =
        ExtractSurface(source.tetrahedra, source.labels);
    const std::vector<Facet>& local = surface.mesh.facets;
    const std::vector<uint32_t> simple = PairHalfEdges(local);
    const auto key_of = [&](uint32_t facet) {
      return Sorted(FacetKey{source.ids[local[facet][0]],
                             source.ids[local[facet][1]],
                             source.ids[local[facet][2]]});
    };
    for (uint32_t i = 0; i < local.size(); ++i) {
      const FacetKey key = key_of(i);
      if (is_ours(std::span<const uint32_t>(key))) {
        facets_.push_back({source.ids[local[i][0]], source.ids[local[i][1]],
                           source.ids[local[i][2]]});
      }
      for (uint32_t half = 3 * i; half < 3 * i + 3; ++half) {
        const uint32_t partner = surface.partners[half];
        if (partner == simple[half]) {
          continue;
        }
        const uint32_t from = source.ids[FromVertex(local, half)];
        const uint32_t to = source.ids[ToVertex(local, half)];
        const std::array<uint32_t, 2> edge = {std::min(from, to),
                                              std::max(from, to)};
        if (is_ours(std::span<const uint32_t>(edge))) {
          const bool has_partner = partner != kNoPartner;
          fixes_.push_back({key, from, to, has_partner,
                            has_partner ? key_of(partner / 3) : FacetKey{}});
        }
      }
    }
  }

  MergedSurface Take() {
    MergedSurface merged;
    std::vector<Facet>& facets = merged.extracted.mesh.facets;
    facets = std::move(facets_);
    merged.ids = NumberVertices(&facets);
    merged.extracted.partners = PairHalfEdges(facets);
    ApplyFixes(merged.ids, &merged.extracted);
    return merged;
  }

 private:
  // Numbers the vertices that are used.
  // \return [V] the plan's vertex of each, ascending
  static std::vector<uint32_t> NumberVertices(std::vector<Facet>* facets) {
    uint32_t end = 0;
    for (const Facet& facet : *facets) {
      end = std::max(end, std::ranges::max(facet) + 1);
    }
    std::vector<uint32_t> numbers(end, kNoSource);
    for (const Facet& facet : *facets) {
      for (const uint32_t id : facet) {
        numbers[id] = 0;
      }
    }
    std::vector<uint32_t> ids;
    for (uint32_t id = 0; id < end; ++id) {
      if (numbers[id] != kNoSource) {
        numbers[id] = static_cast<uint32_t>(ids.size());
        ids.push_back(id);
      }
    }
    for (Facet& facet : *facets) {
      for (uint32_t& vertex : facet) {
        vertex = numbers[vertex];
      }
    }
    return ids;
  }

  void ApplyFixes(const std::vector<uint32_t>& ids,
                  ExtractedSurface* surface) const {
    const std::vector<Facet>& facets = surface->mesh.facets;
    std::unordered_map<FacetKey, uint32_t, KeyHash> places;
    std::vector<uint8_t> is_asked_for(ids.size(), 0);
    for (const PartnerFix& fix : fixes_) {
      for (const FacetKey& facet : {fix.facet, fix.partner}) {
        places[facet] = kNoSource;
        for (const uint32_t id : facet) {
          const auto at = std::ranges::lower_bound(ids, id);
          if (at != ids.end()) {
            is_asked_for[static_cast<size_t>(at - ids.begin())] = 1;
          }
        }
      }
    }
    for (uint32_t i = 0; i < facets.size(); ++i) {
      if (std::ranges::any_of(facets[i], [&](uint32_t vertex) {
            return is_asked_for[vertex] == 0;
          })) {
        continue;
      }
      const auto found = places.find(Sorted(
          FacetKey{ids[facets[i][0]], ids[facets[i][1]], ids[facets[i][2]]}));
      if (found != places.end()) {
        found->second = i;
      }
    }
    for (const PartnerFix& fix : fixes_) {
      const uint32_t half =
          HalfEdgeAt(facets, ids, places.at(fix.facet), fix.from, fix.to);
      surface->partners[half] =
          fix.has_partner ? HalfEdgeAt(facets, ids, places.at(fix.partner),
                                       fix.to, fix.from)
                          : kNoPartner;
    }
  }

  static uint32_t HalfEdgeAt(const std::vector<Facet>& facets,
                             const std::vector<uint32_t>& ids, uint32_t facet,
                             uint32_t from, uint32_t to) {
    for (uint32_t half = 3 * facet; facet != kNoSource && half < 3 * facet + 3;
         ++half) {
      if (ids[FromVertex(facets, half)] == from &&
          ids[ToVertex(facets, half)] == to) {
        return half;
      }
    }
    throw std::logic_error("the surfaces of the tiles do not fit together");
  }

  std::vector<Facet> facets_;  // of the plan's vertices
  std::vector<PartnerFix> fixes_;
};

// Positions of the plan's vertices and of the patch's centroids.
// \param ids  ascending
std::vector<Eigen::Vector3f> PositionsOf(const PlanVertices& plan,
                                         const SingularPatch& patch,
                                         const std::vector<uint32_t>& ids) {
  const auto first_centroid =
      std::ranges::lower_bound(ids, plan.Blocks().NumVertices());
  std::vector<Eigen::Vector3f> positions =
      PositionsOf(plan, std::vector<uint32_t>(ids.begin(), first_centroid));
  for (auto id = first_centroid; id != ids.end(); ++id) {
    positions.push_back(patch.tetrahedra.points[static_cast<size_t>(
        std::ranges::lower_bound(patch.ids, *id) - patch.ids.begin())]);
  }
  return positions;
}

}  // namespace

MergedSurface MergeSurface(const PlanVertices& plan, const TileParts& parts,
                           const SeamLabels& seam, const SingularPatch& patch) {
  const PlanBlocks& blocks = plan.Blocks();
  const auto has_changed = [&](uint32_t id) {
    return patch.changed.contains(id);
  };
  SurfaceCollector collector;
  for (uint32_t tile = 0; tile < blocks.NumTiles(); ++tile) {
    const auto part = parts.ReadPart(tile);
    std::vector<uint8_t> labels = part->labels;
    ApplySeamLabels(seam, part->tile, &labels);
    const uint32_t begin = blocks.FirstVertex(tile);
    const uint32_t end = blocks.FirstVertex(tile + 1);
    collector.Add({part->tile.tetrahedra, labels, part->tile.ids},
                  [&](std::span<const uint32_t> ids) {
                    return ids.front() >= begin && ids.front() < end &&
                           std::ranges::none_of(ids, has_changed);
                  });
  }
  if (!patch.changed.empty()) {
    collector.Add({patch.tetrahedra, patch.labels, patch.ids},
                  [&](std::span<const uint32_t> ids) {
                    return std::ranges::any_of(ids, has_changed);
                  });
  }
  MergedSurface merged = collector.Take();
  merged.extracted.mesh.vertices = PositionsOf(plan, patch, merged.ids);
  return merged;
}

}  // namespace colmap_ext
