#include "meshing/filter_surface.h"

#include <algorithm>
#include <utility>

#include "mesh/clip_mesh.h"
#include "mesh/facet_filters.h"

namespace colmap_ext {
namespace {

void DropFacetsAtEnds(const std::vector<uint8_t>& is_end, FanSplit* surface) {
  const auto is_at_end = [&](uint32_t vertex) {
    const auto& [a, b] = surface->from.vertices[vertex];
    return (a < is_end.size() && is_end[a] != 0) ||
           (b < is_end.size() && is_end[b] != 0);
  };
  std::erase_if(surface->mesh.facets, [&](const Facet& facet) {
    return std::ranges::any_of(facet, is_at_end);
  });
}

// \return how many
size_t DropLongFacets(const ManifoldMeshingOptions& options,
                      TriangleMesh* mesh) {
  const std::vector<float> sides = LongestSides(*mesh);
  const double limit = SideLimit(options.max_side_length_factor,
                                 options.max_side_length_percentile, sides);
  size_t num_kept = 0;
  for (size_t i = 0; i < sides.size(); ++i) {
    if (sides[i] <= limit) {
      mesh->facets[num_kept++] = mesh->facets[i];
    }
  }
  mesh->facets.resize(num_kept);
  return sides.size() - num_kept;
}

// Makes it manifold again.
void SplitAgain(FanSplit* surface) {
  FanSplit split = SplitFans(std::move(surface->mesh));
  split.from = Compose(surface->from, std::move(split.from));
  split.num_split_vertices += surface->num_split_vertices;
  split.num_midpoints += surface->num_midpoints;
  *surface = std::move(split);
}

}  // namespace

FanSplit SplitAndFilter(const ManifoldMeshingOptions& options,
                        ExtractedSurface extracted,
                        const std::vector<uint8_t>& is_end,
                        ManifoldMeshingReport* report) {
  FanSplit surface =
      SplitFans(std::move(extracted.mesh), std::move(extracted.partners));
  surface.from.facets = {};  // not kept in time
  DropFacetsAtEnds(is_end, &surface);
  report->num_long_facets = DropLongFacets(options, &surface.mesh);
  if (options.region) {
    if (auto clipped = ClipMesh(*options.region, &surface.mesh)) {
      surface.from = Compose(surface.from, std::move(*clipped));
    }
  }
  report->small_components = DropSmallComponents(
      static_cast<size_t>(options.min_component_faces), &surface.mesh.facets);
  SplitAgain(&surface);
  report->num_split_vertices = surface.num_split_vertices;
  report->num_midpoints = surface.num_midpoints;
  return surface;
}

}  // namespace colmap_ext
