#include "colmap_ext/jobs/plan.h"

#include <vector>

#include <gtest/gtest.h>

namespace colmap_ext {
namespace job_costs_test {

std::vector<View> Views(size_t count) {
  View view;
  view.width = 4000;
  view.height = 3000;
  return std::vector<View>(count, view);
}

RefinementTile Estimate(size_t num_views, double max_memory_gb, double pixels) {
  RefinementTile tile;
  tile.pixels = pixels;
  EstimateRefinement(Views(num_views), max_memory_gb, &tile);
  return tile;
}

TEST(EstimateRefinement, CountsWhatEachThreadHolds) {
  constexpr double kImageGb = 4000 * 3000 * 9e-9;  // and what is drawn into it
  for (const size_t num_views : {2, 20, 200}) {
    for (const double pixels : {1e6, 1e8}) {
      const RefinementTile kept = Estimate(num_views, 1e3, pixels);
      // A picture of 4 bytes a pixel that is read.
      EXPECT_GT(kept.thread_gb, 4000 * 3000 * 4e-9);
      EXPECT_GT(kept.memory_gb, kImageGb * static_cast<double>(num_views));
      // Where images are not kept, each thread has two of them.
      const RefinementTile dropped = Estimate(num_views, 1e-9, pixels);
      EXPECT_NEAR(dropped.thread_gb - kept.thread_gb, 2 * kImageGb, 1e-6);
      EXPECT_LT(dropped.memory_gb, kept.memory_gb);
      // More of the surface is more for each thread.
      EXPECT_GT(Estimate(num_views, 1e3, 2 * pixels).thread_gb, kept.thread_gb);
    }
  }
}

// A bit for each facet and view.
TEST(EstimateRefinement, CountsWhichViewsSeeEachFacet) {
  const double many = Estimate(800, 1e-9, 1e8).memory_gb;
  const double few = Estimate(8, 1e-9, 1e8).memory_gb;
  constexpr double kFacets = 1e8 / 7;  // at least
  EXPECT_GT(many - few, kFacets * (800 - 8) / 8 * 1e-9);
}

}  // namespace job_costs_test
}  // namespace colmap_ext
