#include "meshing/filter_surface.h"

#include <algorithm>
#include <array>
#include <utility>

#include "mesh/clip_mesh.h"
#include "mesh/facet_filters.h"
#include "mesh/half_edges.h"

namespace colmap_ext {
namespace {

// Makes sources in a surface those that the surface's vertices have themselves.
void ComposeSources(const FanSplit& surface,
                    std::vector<std::array<uint32_t, 2>>* sources) {
  for (auto& [a, b] : *sources) {
    a = surface.sources[a][0];
    b = surface.sources[b][1];
  }
}

// Drops the facets that have an end of rays as a corner, where nothing tells
// whether there is a surface.
// \return how many
size_t DropFacetsAtEnds(const std::vector<uint8_t>& is_end, FanSplit* surface) {
  const auto is_at_end = [&](uint32_t vertex) {
    const auto& [a, b] = surface->sources[vertex];
    return (a < is_end.size() && is_end[a] != 0) ||
           (b < is_end.size() && is_end[b] != 0);
  };
  return std::erase_if(surface->mesh.facets, [&](const Facet& facet) {
    return std::ranges::any_of(facet, is_at_end);
  });
}

// Cuts the surface off at the region's border.
// \return whether it reaches beyond
bool Clip(const Region& region, FanSplit* surface) {
  ClippedMesh clipped = ClipMesh(region, std::move(surface->mesh));
  ComposeSources(*surface, &clipped.sources);
  surface->mesh = std::move(clipped.mesh);
  surface->sources = std::move(clipped.sources);
  return clipped.is_clipped;
}

}  // namespace

void FilterSurface(const ManifoldMeshingOptions& options,
                   const std::vector<uint8_t>& is_end, FanSplit* surface,
                   ManifoldMeshingReport* report) {
  const size_t num_at_ends = DropFacetsAtEnds(is_end, surface);
  report->num_long_facets =
      DropLongFacets(options.max_side_length_factor,
                     options.max_side_length_percentile, &surface->mesh);
  const bool is_clipped = options.region && Clip(*options.region, surface);
  report->small_components = DropSmallComponents(
      static_cast<size_t>(options.min_component_faces), &surface->mesh);
  if (num_at_ends + report->num_long_facets +
              report->small_components.num_facets ==
          0 &&
      !is_clipped) {
    return;
  }
  FanSplit split =
      SplitFans(surface->mesh, PairHalfEdges(surface->mesh.facets));
  ComposeSources(*surface, &split.sources);
  split.num_split_vertices += surface->num_split_vertices;
  split.num_midpoints += surface->num_midpoints;
  *surface = std::move(split);
}

}  // namespace colmap_ext
