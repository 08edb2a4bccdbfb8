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

// ... and of its facets.
void ComposeFacetSources(const FanSplit& surface,
                         std::vector<uint32_t>* facet_sources) {
  for (uint32_t& source : *facet_sources) {
    source = surface.facet_sources[source];
  }
}

// \param is_dropped  [F]
void DropFacets(const std::vector<uint8_t>& is_dropped, FanSplit* surface) {
  size_t num_kept = 0;
  for (size_t i = 0; i < is_dropped.size(); ++i) {
    if (is_dropped[i] == 0) {
      surface->mesh.facets[num_kept] = surface->mesh.facets[i];
      surface->facet_sources[num_kept++] = surface->facet_sources[i];
    }
  }
  surface->mesh.facets.resize(num_kept);
  surface->facet_sources.resize(num_kept);
}

void DropFacetsAtEnds(const std::vector<uint8_t>& is_end, FanSplit* surface) {
  const auto is_at_end = [&](uint32_t vertex) {
    const auto& [a, b] = surface->sources[vertex];
    return (a < is_end.size() && is_end[a] != 0) ||
           (b < is_end.size() && is_end[b] != 0);
  };
  std::vector<uint8_t> is_dropped;
  for (const Facet& facet : surface->mesh.facets) {
    is_dropped.push_back(std::ranges::any_of(facet, is_at_end));
  }
  DropFacets(is_dropped, surface);
}

// \return how many of those that count
size_t DropLongFacets(double longest_side,
                      const std::vector<uint8_t>& is_counted,
                      FanSplit* surface) {
  const std::vector<float> sides = LongestSides(surface->mesh);
  std::vector<uint8_t> is_dropped(sides.size(), 0);
  size_t count = 0;
  for (size_t i = 0; i < sides.size(); ++i) {
    is_dropped[i] = sides[i] > longest_side;
    count += is_dropped[i] != 0 &&
             (is_counted.empty() || is_counted[surface->facet_sources[i]] != 0);
  }
  DropFacets(is_dropped, surface);
  return count;
}

// Cuts the surface off at the region's border.
void Clip(const Region& region, float largest_coordinate, FanSplit* surface) {
  ClippedMesh clipped =
      ClipMesh(region, std::move(surface->mesh), largest_coordinate);
  ComposeSources(*surface, &clipped.sources);
  ComposeFacetSources(*surface, &clipped.facet_sources);
  surface->mesh = std::move(clipped.mesh);
  surface->sources = std::move(clipped.sources);
  surface->facet_sources = std::move(clipped.facet_sources);
}

// Makes it manifold again.
void SplitAgain(const std::vector<uint8_t>& is_counted, FanSplit* surface) {
  FanSplit split =
      SplitFans(surface->mesh, PairHalfEdges(surface->mesh.facets));
  OrderByUse(&split);
  if (!is_counted.empty()) {
    std::vector<uint8_t> counts;
    for (const uint32_t source : surface->facet_sources) {
      counts.push_back(is_counted[source]);
    }
    CountPart(counts, &split);
  }
  ComposeSources(*surface, &split.sources);
  ComposeFacetSources(*surface, &split.facet_sources);
  split.num_split_vertices += surface->num_split_vertices;
  split.num_midpoints += surface->num_midpoints;
  *surface = std::move(split);
}

}  // namespace

SurfaceLimits LimitsOf(const ManifoldMeshingOptions& options,
                       const TriangleMesh& mesh) {
  return {
      SideLimit(options.max_side_length_factor,
                options.max_side_length_percentile, LongestSides(mesh)),
      LargestCoordinate(mesh),
  };
}

FanSplit SplitWithoutEnds(const ExtractedSurface& extracted,
                          const std::vector<uint8_t>& is_end,
                          const std::vector<uint8_t>& is_counted) {
  FanSplit surface = SplitFans(extracted.mesh, extracted.partners);
  OrderByUse(&surface);
  if (!is_counted.empty()) {
    CountPart(is_counted, &surface);
  }
  DropFacetsAtEnds(is_end, &surface);
  return surface;
}

void FilterSurface(const ManifoldMeshingOptions& options,
                   const SurfaceLimits& limits,
                   const std::vector<uint8_t>& is_counted, FanSplit* surface,
                   ManifoldMeshingReport* report) {
  report->num_long_facets +=
      DropLongFacets(limits.longest_side, is_counted, surface);
  if (options.region) {
    Clip(*options.region, limits.largest_coordinate, surface);
  }
  report->small_components =
      DropSmallComponents(static_cast<size_t>(options.min_component_faces),
                          &surface->mesh, &surface->facet_sources);
  SplitAgain(is_counted, surface);
  report->num_split_vertices += surface->num_split_vertices;
  report->num_midpoints += surface->num_midpoints;
}

}  // namespace colmap_ext
