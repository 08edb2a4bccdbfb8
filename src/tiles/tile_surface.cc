#include "tiles/tile_surface.h"

#include <algorithm>
#include <array>

#include "mesh/half_edges.h"

namespace colmap_ext {
namespace {

// A part of all cells.
struct Source {
  const Tetrahedralization& tetrahedra;
  const std::vector<uint8_t>& labels;
  const std::vector<uint32_t>& ids;
};

// Extracts the surface of a source. Calls add_facet(facet) for each facet, by
// the plan's vertices, and takes the fixes at edges, two vertices ascending,
// that is_ours(first, second) holds for.
template <typename AddFacet, typename IsOurs>
void Extract(const Source& source, const AddFacet& add_facet,
             const IsOurs& is_ours, std::vector<PartnerFix>* fixes) {
  const ExtractedSurface surface =
      ExtractSurface(source.tetrahedra, source.labels);
  const std::vector<Facet>& local = surface.mesh.facets;
  const auto facet_of = [&](uint32_t i) {
    return Facet{source.ids[local[i][0]], source.ids[local[i][1]],
                 source.ids[local[i][2]]};
  };
  for (uint32_t i = 0; i < local.size(); ++i) {
    add_facet(facet_of(i));
  }
  const std::vector<uint32_t> simple = PairHalfEdges(local);
  for (uint32_t half = 0; half < simple.size(); ++half) {
    const uint32_t partner = surface.partners[half];
    const uint32_t from = source.ids[FromVertex(local, half)];
    const uint32_t to = source.ids[ToVertex(local, half)];
    if (partner == simple[half] ||
        !is_ours(std::min(from, to), std::max(from, to))) {
      continue;
    }
    const bool has_partner = partner != kNoPartner;
    fixes->push_back(
        {Sorted(facet_of(half / 3)), from, to, has_partner,
         has_partner ? Sorted(facet_of(partner / 3)) : FacetKey{}});
  }
}

}  // namespace

PlanSurface::PlanSurface(const PlanVertices& plan, const TileParts& parts,
                         const SeamLabels& seam, const SingularPatch& patch)
    : blocks_(plan.Blocks()), parts_(parts), seam_(seam), patch_(patch) {
  if (patch.changed.empty()) {
    return;
  }
  Extract(
      {patch.tetrahedra, patch.labels, patch.ids},
      [&](const Facet& facet) {
        if (std::ranges::any_of(facet,
                                [&](uint32_t id) { return HasChanged(id); })) {
          patch_facets_.push_back(facet);
        }
      },
      [&](uint32_t a, uint32_t b) { return HasChanged(a) || HasChanged(b); },
      &patch_fixes_);
}

uint32_t PlanSurface::TileOf(const Facet& facet) const {
  const uint32_t first = std::ranges::min(facet);
  return first < blocks_.NumVertices()
             ? blocks_.TileOf(first)
             : static_cast<uint32_t>(blocks_.NumTiles() - 1);
}

TileSurface PlanSurface::Read(uint32_t tile) const {
  const auto part = parts_.ReadPart(tile);
  std::vector<uint8_t> labels = part->labels;
  ApplySeamLabels(seam_, part->tile, &labels);
  const uint32_t begin = blocks_.FirstVertex(tile);
  const uint32_t end = blocks_.FirstVertex(tile + 1);
  TileSurface surface;
  const auto add = [&](const Facet& facet, bool is_own) {
    if (is_own) {
      surface.facets.push_back(facet);
      return;
    }
    for (const uint32_t id : facet) {
      if (id >= begin && id < end) {
        surface.touched.push_back(id);
      }
    }
  };
  Extract(
      {part->tile.tetrahedra, labels, part->tile.ids},
      [&](const Facet& facet) {
        if (std::ranges::none_of(facet,
                                 [&](uint32_t id) { return HasChanged(id); })) {
          const uint32_t first = std::ranges::min(facet);
          add(facet, first >= begin && first < end);
        }
      },
      [&](uint32_t a, uint32_t b) {
        return a >= begin && a < end && !HasChanged(a) && !HasChanged(b);
      },
      &surface.fixes);
  for (const Facet& facet : patch_facets_) {
    add(facet, TileOf(facet) == tile);
  }
  std::ranges::sort(surface.touched);
  surface.touched.erase(
      std::unique(surface.touched.begin(), surface.touched.end()),
      surface.touched.end());
  return surface;
}

}  // namespace colmap_ext
