#include "merging/tile_surface.h"

#include <algorithm>

#include "mesh/adjacency.h"
#include "meshing/surface_extraction.h"

namespace colmap_ext {

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

}  // namespace colmap_ext
