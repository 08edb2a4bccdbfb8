#include "colmap_ext/jobs/refinement_estimate.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <tbb/task_arena.h>

#include "base/indices.h"
#include "colmap_ext/terminal/terminal.h"
#include "refine/facet_sizes.h"
#include "spatial/facet_tree.h"

namespace colmap_ext {

double MaxMemoryGb(const RefinerOptions& options) {
  constexpr double kShare = 0.75;  // The rest is for others: a choice.
  return options.max_memory_gb == kAutoMemory
             ? kShare * 1e-9 * static_cast<double>(MachineMemory())
             : options.max_memory_gb;
}

void EstimateRefinement(const std::vector<View>& views, double max_memory_gb,
                        int num_threads, double gb_per_facet,
                        RefinementTile* tile) {
  // Fitted to the scenes of docs/results.md. The program:
  constexpr double kBaseGb = 0.055;
  // A pixel of an image with what is drawn into it.
  constexpr double kGbPerImagePixel = 4e-9;
  // Each thread: what it compares with and projects by, a picture that it reads
  // (4 bytes a pixel), and two that it compares, with what is drawn into them,
  // beyond what is kept of all.
  constexpr double kGbPerThread = 0.004;
  constexpr double kGbPerReadPixel = 4e-9;
  constexpr double kSecondsPerFacet = 2.8e-4;
  constexpr double kSecondsPerImagePixel = 2e-6;
  // Of max_memory_gb: what the estimate may be wrong by, and what is always
  // left for images. Choices.
  constexpr double kReserve = 0.1;
  constexpr double kMinImageShare = 0.125;
  double num_pixels = 0;
  double largest = 0;
  for (const View& view : views) {
    const double size = static_cast<double>(view.width) * view.height;
    num_pixels += size;
    largest = std::max(largest, size);
  }
  const double images_gb = kGbPerImagePixel * num_pixels;
  const double pair_gb = 2 * kGbPerImagePixel * largest;
  const double thread_gb = kGbPerThread + kGbPerReadPixel * largest;
  const double rest_gb = kBaseGb + gb_per_facet * tile->facets;
  tile->cache_gb = std::max((1 - kReserve) * max_memory_gb - rest_gb -
                                num_threads * (thread_gb + pair_gb),
                            kMinImageShare * max_memory_gb);
  const double kept_gb = std::min(tile->cache_gb, images_gb);
  tile->memory_gb = rest_gb + kept_gb;
  tile->thread_gb = thread_gb + std::min(pair_gb, images_gb - kept_gb);
  tile->core_seconds =
      kSecondsPerFacet * tile->facets + kSecondsPerImagePixel * num_pixels;
}

void EstimateJobs(const Surface& surface, const TileCells& cells,
                  const std::vector<View>& views, const RefinerOptions& options,
                  double gb_per_facet, std::vector<RefinementTile>* tiles) {
  constexpr double kInputShare = 0.4;  // of a refined facet's memory; measured
  const std::vector<float> parts =
      ExpectedParts(options.refinement.max_face_area, surface.mesh,
                    surface.attributes.views, views);
  for (size_t tile = 0; tile < cells.size(); ++tile) {
    RefinementTile& job = (*tiles)[tile];
    const Eigen::AlignedBox3f cell =
        GrowBox(cells[tile], static_cast<float>(job.margin));
    std::vector<uint8_t> is_seen_by(views.size(), 0);
    double num_parts = 0;
    for (size_t i = 0; i < parts.size(); ++i) {
      const Facet& facet = surface.mesh.facets[i];
      if (cell.intersects(BoxOf(surface.mesh, facet))) {
        job.facets += 1;
        num_parts += parts[i];
        for (const uint32_t vertex : facet) {
          for (const uint32_t view : surface.attributes.views[vertex]) {
            is_seen_by[view] = 1;
          }
        }
      }
    }
    job.facets = std::max(kInputShare * job.facets, num_parts);
    std::vector<View> of_tile;
    for (const uint32_t view : Marked(is_seen_by)) {
      of_tile.push_back(views[view]);
    }
    EstimateRefinement(of_tile, MaxMemoryGb(options),
                       tbb::this_task_arena::max_concurrency(), gb_per_facet,
                       &job);
    // Of the time by defaults; fitted to sceaux, bunny, and fountain. Most
    // levels end before ten iterations.
    const FacetwiseRefinementOptions& method = options.refinement;
    job.core_seconds *= 0.12 + 0.11 * method.levels +
                        0.022 * std::min(method.iterations, 10) +
                        0.018 * method.labeling.final_pairs_per_facet;
  }
}

RefinementTile EstimateRun(const Surface& surface,
                           const std::vector<View>& views,
                           const RefinerOptions& options) {
  const Eigen::Vector3f far = Eigen::Vector3f::Constant(HUGE_VALF);
  std::vector<RefinementTile> all(1);
  EstimateJobs(surface, {{-far, far}}, views, options, kUsualGbPerFacet, &all);
  return all[0];
}

}  // namespace colmap_ext
