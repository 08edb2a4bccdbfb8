#include "colmap_ext/jobs/refinement_estimate.h"

#include <algorithm>
#include <cstdint>
#include <limits>

#include "base/indices.h"
#include "mesh/mesh_in_image.h"
#include "mesh/normals.h"
#include "spatial/facet_tree.h"

namespace colmap_ext {

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
  // A bit for each view, see FacetIdBuffer::is_facing.
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

void EstimateJobs(const Surface& surface, const TileCells& cells,
                  const std::vector<View>& views, double max_memory_gb,
                  std::vector<RefinementTile>* tiles) {
  constexpr double kMinPixels = 7;  // that a facet takes as much as
  std::vector<std::vector<uint8_t>> is_seen_by(
      cells.size(), std::vector<uint8_t>(views.size(), 0));
  std::vector<double> footprints;
  for (uint32_t i = 0; i < surface.mesh.vertices.size(); ++i) {
    footprints.push_back(NearestFootprint(surface.mesh.vertices[i],
                                          surface.attributes.views[i], views));
  }
  for (const Facet& facet : surface.mesh.facets) {
    const auto& [a, b, c] = facet;
    const double area = AreaVector(surface.mesh, facet).norm() / 2;
    const double footprint =
        std::max({footprints[a], footprints[b], footprints[c]});
    const Eigen::AlignedBox3f box = BoxOf(surface.mesh, facet);
    for (size_t tile = 0; tile < cells.size(); ++tile) {
      const auto margin = static_cast<float>((*tiles)[tile].margin);
      if (GrowBox(cells[tile], margin).intersects(box)) {
        (*tiles)[tile].pixels +=
            std::max(kMinPixels, area / (footprint * footprint));
        for (const uint32_t vertex : facet) {
          for (const uint32_t view : surface.attributes.views[vertex]) {
            is_seen_by[tile][view] = 1;
          }
        }
      }
    }
  }
  for (size_t tile = 0; tile < cells.size(); ++tile) {
    std::vector<View> of_tile;
    for (const uint32_t view : Marked(is_seen_by[tile])) {
      of_tile.push_back(views[view]);
    }
    EstimateRefinement(of_tile, max_memory_gb, &(*tiles)[tile]);
  }
}

RefinementEstimate EstimateRun(const Surface& surface,
                               const std::vector<View>& views,
                               double max_memory_gb, int num_threads) {
  // Fitted to the scenes of docs/results.md, with their defaults.
  constexpr double kBaseGb = 0.12;
  constexpr double kGbPerPixel = 6e-8;
  constexpr double kGbPerImagePixel = 9e-9;
  constexpr double kGbPerThread = 0.004;
  constexpr double kGbPerReadPixel = 4e-9;
  constexpr double kSecondsPerPixel = 2.2e-5;
  constexpr double kSecondsPerImagePixel = 2e-6;
  const auto far =
      Eigen::Vector3f::Constant(std::numeric_limits<float>::infinity()).eval();
  std::vector<RefinementTile> all(1);
  EstimateJobs(surface, {{-far, far}}, views, max_memory_gb, &all);
  double num_pixels = 0;
  double largest = 0;
  for (const View& view : views) {
    const double size = static_cast<double>(view.width) * view.height;
    num_pixels += size;
    largest = std::max(largest, size);
  }
  return {
      std::min(max_memory_gb, kGbPerImagePixel * num_pixels) + kBaseGb +
          num_threads * (kGbPerThread + kGbPerReadPixel * largest),
      kGbPerPixel * all[0].pixels,
      kSecondsPerPixel * all[0].pixels + kSecondsPerImagePixel * num_pixels};
}

}  // namespace colmap_ext
