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
                        double gb_per_pixel, RefinementTile* tile) {
  // Fitted to the scenes of docs/results.md. The program:
  constexpr double kBaseGb = 0.07;
  // A pixel of an image with what is drawn into it.
  constexpr double kGbPerImagePixel = 4e-9;
  // Each thread: what it compares with and projects by, a picture that it reads
  // (4 bytes a pixel), and two that it compares, with what is drawn into them,
  // beyond what is kept of all.
  constexpr double kGbPerThread = 0.004;
  constexpr double kGbPerReadPixel = 4e-9;
  constexpr double kSecondsPerPixel = 2.2e-5;
  constexpr double kSecondsPerImagePixel = 2e-6;
  double num_pixels = 0;
  double largest = 0;
  for (const View& view : views) {
    const double size = static_cast<double>(view.width) * view.height;
    num_pixels += size;
    largest = std::max(largest, size);
  }
  const double images_gb = kGbPerImagePixel * num_pixels;
  const double kept_gb = std::min(max_memory_gb, images_gb);
  tile->memory_gb = kBaseGb + gb_per_pixel * tile->pixels + kept_gb;
  tile->thread_gb =
      kGbPerThread + kGbPerReadPixel * largest +
      std::min(2 * kGbPerImagePixel * largest, images_gb - kept_gb);
  tile->core_seconds =
      kSecondsPerPixel * tile->pixels + kSecondsPerImagePixel * num_pixels;
}

void EstimateJobs(const Surface& surface, const TileCells& cells,
                  const std::vector<View>& views, double max_memory_gb,
                  double gb_per_pixel, std::vector<RefinementTile>* tiles) {
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
    EstimateRefinement(of_tile, max_memory_gb, gb_per_pixel, &(*tiles)[tile]);
  }
}

RefinementTile EstimateRun(const Surface& surface,
                           const std::vector<View>& views,
                           double max_memory_gb) {
  const auto far =
      Eigen::Vector3f::Constant(std::numeric_limits<float>::infinity()).eval();
  std::vector<RefinementTile> all(1);
  EstimateJobs(surface, {{-far, far}}, views, max_memory_gb, kUsualGbPerPixel,
               &all);
  return all[0];
}

}  // namespace colmap_ext
