#include "tiles/merged_plan.h"

#include <algorithm>
#include <unordered_map>

#include "base/indices.h"
#include "mesh/adjacency.h"

namespace colmap_ext {
namespace {

// Numbers the vertices that are used.
// \return [V] the plan's vertex of each, ascending
std::vector<uint32_t> NumberVertices(std::vector<Facet>* facets) {
  std::vector<uint32_t> ids;
  ids.reserve(3 * facets->size());
  for (const Facet& facet : *facets) {
    Append(facet, &ids);
  }
  SortUnique(&ids);
  ids.shrink_to_fit();
  for (Facet& facet : *facets) {
    for (uint32_t& vertex : facet) {
      vertex = IndexOf(ids, vertex);
    }
  }
  return ids;
}

using PlacesByKey = std::unordered_map<FacetKey, uint32_t, KeyHash>;

// Where the facets of the fixes are, by the plan's vertices; kNone: nowhere.
PlacesByKey FindPlaces(const std::vector<PartnerFix>& fixes,
                       const std::vector<uint32_t>& ids,
                       const std::vector<Facet>& facets) {
  PlacesByKey places;
  std::vector<uint8_t> is_asked_for(ids.size(), 0);
  for (const PartnerFix& fix : fixes) {
    for (const FacetKey& facet : {fix.facet, fix.partner}) {
      places[facet] = kNone;
      for (const uint32_t id : facet) {
        const uint32_t at = IndexOf(ids, id);
        if (at != kNone) {
          is_asked_for[at] = 1;
        }
      }
    }
  }
  for (uint32_t i = 0; i < facets.size(); ++i) {
    const auto& [a, b, c] = facets[i];
    if (is_asked_for[a] != 0 && is_asked_for[b] != 0 && is_asked_for[c] != 0) {
      const auto found = places.find(Sorted(FacetKey{ids[a], ids[b], ids[c]}));
      if (found != places.end()) {
        found->second = i;
      }
    }
  }
  return places;
}

void FixPartners(const std::vector<PartnerFix>& fixes, MergedSurface* merged) {
  const std::vector<uint32_t>& ids = merged->ids;
  const std::vector<Facet>& facets = merged->extracted.mesh.facets;
  const PlacesByKey places = FindPlaces(fixes, ids, facets);
  // kNone of a facet that is not there.
  const auto half_edge_at = [&](const FacetKey& facet, uint32_t from,
                                uint32_t to) {
    const uint32_t place = places.at(facet);
    for (uint32_t half = 3 * place; place != kNone && half < 3 * place + 3;
         ++half) {
      if (ids[FromVertex(facets, half)] == from &&
          ids[ToVertex(facets, half)] == to) {
        return half;
      }
    }
    return kNone;
  };
  for (const auto& [facet, from, to, partner] : fixes) {
    const uint32_t half = half_edge_at(facet, from, to);
    if (half != kNone) {
      merged->extracted.partners[half] = half_edge_at(partner, to, from);
    }
  }
}

}  // namespace

uint32_t CellChanges::Split(const CellKey& corners,
                            const Eigen::Vector3f& centroid) {
  const uint32_t vertex =
      ExpectIndexable(blocks_.NumVertices() + centroids_.size() + 1,
                      "vertices") -
      1;
  changes_[Sorted(corners)].centroid = vertex;
  vertices_.insert(corners.begin(), corners.end());
  centroids_.push_back(centroid);
  tiles_.push_back(TileOf(std::ranges::min(corners)));
  return vertex;
}

void CellChanges::SetLabel(const CellKey& corners, uint8_t label) {
  changes_[Sorted(corners)].label = label;
  vertices_.insert(corners.begin(), corners.end());
}

CellChanges::Change CellChanges::Of(const CellKey& corners) const {
  const auto found = changes_.find(Sorted(corners));
  return found != changes_.end() ? found->second : Change();
}

uint32_t CellChanges::TileOf(uint32_t vertex) const {
  return vertex < blocks_.NumVertices()
             ? blocks_.TileOf(vertex)
             : tiles_[vertex - blocks_.NumVertices()];
}

std::vector<Eigen::Vector3f> CellChanges::PositionsOf(
    const std::vector<uint32_t>& ids) const {
  const uint32_t num_vertices = blocks_.NumVertices();
  const auto first_centroid = std::ranges::lower_bound(ids, num_vertices);
  std::vector<Eigen::Vector3f> positions = colmap_ext::PositionsOf(
      seam_.plan(), std::vector<uint32_t>(ids.begin(), first_centroid));
  for (auto id = first_centroid; id != ids.end(); ++id) {
    positions.push_back(centroids_[*id - num_vertices]);
  }
  return positions;
}

TilePart CellChanges::ReadPart(uint32_t tile) const {
  TilePart part = seam_.ReadPart(tile);
  std::vector<uint8_t> is_at_change;
  for (const uint32_t id : part.tile.ids) {
    is_at_change.push_back(vertices_.contains(id));
  }
  const auto& cells = part.tile.tetrahedra.cells;
  const auto num_cells = static_cast<uint32_t>(cells.size());
  for (uint32_t cell = 0; cell < num_cells; ++cell) {
    if (std::ranges::all_of(cells[cell].vertices, [&](uint32_t vertex) {
          return vertex == kInfiniteVertex || is_at_change[vertex] != 0;
        })) {
      ApplyTo(cell, &part);
    }
  }
  return part;
}

// And what is made of its parts.
void CellChanges::ApplyTo(uint32_t cell, TilePart* part) const {
  const auto [centroid, label] = Of(part->tile.CornersOf(cell));
  if (centroid == kNone) {
    part->labels[cell] = label != kNotKnown ? label : part->labels[cell];
    return;
  }
  const auto first_new = static_cast<uint32_t>(part->labels.size());
  SplitCell(cell, &part->tile.tetrahedra, nullptr, &part->labels);
  part->tile.ids.push_back(centroid);
  for (const uint32_t child : {cell, first_new, first_new + 1, first_new + 2}) {
    ApplyTo(child, part);
  }
}

TileSurface SurfaceOf(const CellChanges& changes, uint32_t tile) {
  const TilePart part = changes.ReadPart(tile);
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
    if (changes.TileOf(std::ranges::min(facet)) == tile) {
      surface.facets.push_back(facet);
    }
  }
  const std::vector<uint32_t> simple = PairHalfEdges(local);
  for (uint32_t half = 0; half < simple.size(); ++half) {
    const uint32_t partner = extracted.partners[half];
    const uint32_t from = ids[FromVertex(local, half)];
    const uint32_t to = ids[ToVertex(local, half)];
    if (partner == simple[half] || changes.TileOf(std::min(from, to)) != tile) {
      continue;
    }
    surface.fixes.push_back(
        {Sorted(facet_of(half / 3)), from, to,
         partner != kNone ? Sorted(facet_of(partner / 3)) : FacetKey{}});
  }
  return surface;
}

MergedSurface MergeSurface(const CellChanges& changes) {
  MergedSurface merged;
  std::vector<Facet>& facets = merged.extracted.mesh.facets;
  std::vector<PartnerFix> fixes;
  for (uint32_t tile = 0; tile < changes.seam().NumTiles(); ++tile) {
    const TileSurface surface = SurfaceOf(changes, tile);
    Append(surface.facets, &facets);
    Append(surface.fixes, &fixes);
  }
  merged.ids = NumberVertices(&facets);
  merged.extracted.partners = PairHalfEdges(facets);
  FixPartners(fixes, &merged);
  merged.extracted.mesh.vertices = changes.PositionsOf(merged.ids);
  return merged;
}

}  // namespace colmap_ext
