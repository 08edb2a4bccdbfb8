#include "merging/surface_bands.h"

#include <algorithm>
#include <unordered_set>

namespace colmap_ext {

SurfaceBands::SurfaceBands(const PlanVertices& plan,
                           std::vector<Eigen::Vector3f> centroids,
                           const MakeStore& make_store)
    : plan_(plan), centroids_(std::move(centroids)), facets_(make_store) {}

void SurfaceBands::Add(const TileSurface& surface) {
  AddRim(surface);
  facets_.Append(surface.facets);
  begins_.push_back(facets_.size());
  fixes_.insert(fixes_.end(), surface.fixes.begin(), surface.fixes.end());
}

void SurfaceBands::AddRim(const TileSurface& surface) {
  const auto tile = static_cast<uint32_t>(begins_.size() - 1);
  const uint32_t begin = plan_.Blocks().FirstVertex(tile);
  const uint32_t end = plan_.Blocks().FirstVertex(tile + 1);
  // Of the tile's vertices, how many edges off another tile's facets. What
  // other vertices there are may be at facets of others.
  std::vector<uint8_t> rings(end - begin, kBandRings);
  for (const uint32_t id : surface.touched) {
    rings[id - begin] = 0;
  }
  const auto ring_of = [&](uint32_t id) {
    return id >= begin && id < end ? rings[id - begin] : uint8_t{0};
  };
  const auto ring_of_facet = [&](const Facet& facet) {
    return std::min({ring_of(facet[0]), ring_of(facet[1]), ring_of(facet[2])});
  };
  for (uint8_t ring = 0; ring + 1 < kBandRings; ++ring) {
    for (const Facet& facet : surface.facets) {
      if (ring_of_facet(facet) == ring) {
        for (const uint32_t id : facet) {
          if (ring_of(id) > ring + 1) {
            rings[id - begin] = ring + 1;
          }
        }
      }
    }
  }
  for (const Facet& facet : surface.facets) {
    if (ring_of_facet(facet) < kBandRings) {
      rim_.push_back({facet, tile});
    }
  }
}

void SurfaceBands::Finish() {
  at_.reserve(3 * rim_.size());
  for (uint32_t i = 0; i < rim_.size(); ++i) {
    for (const uint32_t id : rim_[i].facet) {
      at_.emplace_back(id, i);
    }
  }
  std::ranges::sort(at_);
}

// Facets of the rim around a tile's, ascending.
std::vector<uint32_t> SurfaceBands::RimAround(uint32_t tile) const {
  std::vector<uint32_t> found;
  std::unordered_set<uint32_t> is_found;
  std::unordered_set<uint32_t> reached;
  std::vector<uint32_t> front;
  const auto reach = [&](const Facet& facet) {
    for (const uint32_t id : facet) {
      if (reached.insert(id).second) {
        front.push_back(id);
      }
    }
  };
  for (auto own = std::ranges::lower_bound(rim_, tile, {}, &RimFacet::tile);
       own != rim_.end() && own->tile == tile; ++own) {
    reach(own->facet);
  }
  for (uint8_t ring = 0; ring < kBandRings; ++ring) {
    for (const uint32_t id : std::exchange(front, {})) {
      for (auto at = std::ranges::lower_bound(at_, std::pair(id, 0U));
           at != at_.end() && at->first == id; ++at) {
        const RimFacet& facet = rim_[at->second];
        if (facet.tile != tile && is_found.insert(at->second).second) {
          found.push_back(at->second);
          reach(facet.facet);
        }
      }
    }
  }
  std::ranges::sort(found);
  return found;
}

SurfaceBand SurfaceBands::Read(uint32_t tile) const {
  SurfaceBand band;
  std::vector<Facet> facets;
  const std::vector<uint32_t> around = RimAround(tile);
  const auto first_after = std::ranges::lower_bound(
      around, tile, {}, [&](uint32_t i) { return rim_[i].tile; });
  for (auto i = around.begin(); i != first_after; ++i) {
    facets.push_back(rim_[*i].facet);
  }
  band.is_own.assign(facets.size(), 0);
  const std::vector<Facet> own = facets_.Read(begins_[tile], begins_[tile + 1]);
  facets.insert(facets.end(), own.begin(), own.end());
  band.is_own.resize(facets.size(), 1);
  for (auto i = first_after; i != around.end(); ++i) {
    facets.push_back(rim_[*i].facet);
  }
  band.is_own.resize(facets.size(), 0);
  band.keys.assign(facets.begin(), facets.end());
  band.surface = ConnectFacets(std::move(facets), fixes_);
  band.surface.extracted.mesh.vertices =
      PositionsOf(plan_, centroids_, band.surface.ids);
  return band;
}

}  // namespace colmap_ext
