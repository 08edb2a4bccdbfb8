#include "colmap_ext/jobs/plan.h"

#include <algorithm>
#include <cmath>

#include "tiles/tile_cut.h"

namespace colmap_ext {
namespace {

// Of a tile within others, its own vertices and those of others that its job
// holds, which lie along the borders.
double NumHeld(size_t num_vertices) {
  const auto own = static_cast<double>(num_vertices);
  return own + 640 * std::sqrt(own);
}

}  // namespace

double TileMemoryGb(size_t num_vertices) {
  return 0.06 + 830e-9 * NumHeld(num_vertices);
}

size_t NumTilesForMemory(const PlannerOptions& options, size_t num_points) {
  // How many of the points are vertices after the usual thinning. Measured on:
  // fountain, bunny and sceaux, 0.26 to 0.35.
  constexpr double kThinnedShare = 0.3;
  const double num_vertices =
      (options.mesher.meshing.max_proj_dist > 0 ? kThinnedShare : 1) *
      static_cast<double>(num_points);
  size_t num_tiles = 1;
  while (num_tiles < num_points &&
         TileMemoryGb(static_cast<size_t>(num_vertices /
                                          static_cast<double>(num_tiles))) >
             options.max_memory_gb) {
    ++num_tiles;
  }
  return num_tiles;
}

double TileSeconds(size_t num_vertices) {
  return 1 + 60e-6 * NumHeld(num_vertices);
}

double MergerMemoryGb(const Plan& plan, const PlannerOptions& options) {
  // The cells of one tile, without its rays, and the seams read last.
  constexpr double kSeamsGb = 0.07;
  double num_vertices = 0;
  double largest = 0;
  for (const PlannedTile& tile : plan.tiles) {
    num_vertices += static_cast<double>(tile.num_vertices);
    largest = std::max(largest, static_cast<double>(tile.num_vertices));
  }
  // Borders and remeshing take the adjacency of the whole surface.
  const ManifoldMeshingOptions& meshing = options.mesher.meshing;
  const bool takes_adjacency = meshing.borders.trim > 0 ||
                               meshing.borders.close_holes != 0 ||
                               meshing.remeshing;
  const double bytes_a_vertex = takes_adjacency ? 390 : 150;
  const double all_seams =
      options.seam_rings == kAllAtOnce ? 600e-9 * num_vertices : 0;
  return std::max(
      kSeamsGb + TileMemoryGb(static_cast<size_t>(largest)) + all_seams,
      0.06 + 1e-9 * bytes_a_vertex * num_vertices);
}

void EstimateRefinement(const std::vector<View>& views, double max_memory_gb,
                        RefinementTile* tile) {
  // Fitted to tiles of bunny (docs/experiments.md), rounded up: what a square
  // pixel of surface takes, and one of an image with what is drawn into it.
  // The program, with the software that draws where there is no card.
  constexpr double kBaseGb = 0.12;
  constexpr double kGbPerPixel = 1.5e-7;
  constexpr double kGbPerImagePixel = 9e-9;
  constexpr double kSecondsPerPixel = 4e-5;
  // Facets: max_face_area's default of 7, cut in four where they are larger.
  constexpr double kFacetsPerPixel = 4.0 / 7;
  // A bit for each view that may see a facet, see FindVisibleFacets().
  constexpr double kGbPerFacetAndView = 1e-9 / 8;
  // Each thread: what it compares with and projects by, a picture that it reads
  // (4 bytes a pixel), and two that it compares, with what is drawn into them,
  // beyond what is kept of all.
  constexpr double kGbPerThread = 0.004;
  constexpr double kGbPerReadPixel = 4e-9;
  // ... and the sums of the facets of five directions, which wait for their
  // turn (photometry/photometric_energy.cc), and the places of all facets.
  constexpr double kGbPerSum = 5 * 48e-9;
  constexpr double kGbPerPlace = 0.25e-9;
  // The facets of a direction, in shares of all: 18 labels a facet, each in one
  // of the two directions of some 3 pairs a view, are 3 / views. Three times as
  // many as in the mean one.
  constexpr double kDirectionShare = 9;
  double num_pixels = 0;
  double largest = 0;
  for (const View& view : views) {
    const double size = static_cast<double>(view.width) * view.height;
    num_pixels += size;
    largest = std::max(largest, size);
  }
  const auto num_views = static_cast<double>(views.size());
  const double num_facets = kFacetsPerPixel * tile->pixels;
  const double images_gb = kGbPerImagePixel * num_pixels;
  const double kept_gb = std::min(max_memory_gb, images_gb);
  const double share =
      std::min(1.0, kDirectionShare / std::max(1.0, num_views));
  tile->memory_gb = kBaseGb + kGbPerPixel * tile->pixels + kept_gb +
                    kGbPerFacetAndView * num_views * num_facets;
  tile->thread_gb =
      kGbPerThread + kGbPerReadPixel * largest +
      std::min(2 * kGbPerImagePixel * largest, images_gb - kept_gb) +
      (kGbPerSum * share + kGbPerPlace) * num_facets;
  tile->core_seconds = kSecondsPerPixel * tile->pixels;
}

}  // namespace colmap_ext
