#include "colmap_ext/jobs/refinement_estimate.h"

#include <gtest/gtest.h>

#include "base/indices.h"
#include "tests/mesh/known_meshes.h"

namespace colmap_ext::refinement_estimate_test {

constexpr double kEnoughGb = 1e3;
constexpr uint32_t kNumQuads = 8;  // along each side, of a scene unit

// A sheet ten units before a camera whose pixels are 10 / focal_length of a
// unit on it.
RefinementTile Estimate(double focal_length, double max_memory_gb,
                        size_t num_views = 1) {
  Surface surface{MakeSheet(kNumQuads, kNumQuads), {}};
  for (size_t i = 0; i < surface.mesh.vertices.size(); ++i) {
    surface.attributes.views.AddRow(Iota(static_cast<uint32_t>(num_views)));
  }
  View view{"", 4000, 3000};
  view.fx = view.fy = focal_length;
  view.cam_from_world_translation.z() = 10;
  return EstimateRun(surface, std::vector<View>(num_views, view),
                     max_memory_gb);
}

TEST(EstimateRun, TakesTheSurfaceByItsPixels) {
  const double fine = Estimate(2000, kEnoughGb).pixels;
  const double usual = Estimate(1000, kEnoughGb).pixels;
  EXPECT_NEAR(fine / usual, 4, 1e-3);
  // A facet takes as much as seven pixels, however small it is.
  const double coarse = Estimate(1, kEnoughGb).pixels;
  EXPECT_NEAR(usual / coarse, 100 * 100 / 2.0 / 7, 1e-3);
  EXPECT_EQ(Estimate(0.5, kEnoughGb).pixels, coarse);
}

TEST(EstimateRun, TakesImagesUpToWhatIsKeptAndOneForEachThread) {
  constexpr double kPixelsGb = 4000 * 3000 * 1e-9;  // a byte for each
  const double one = Estimate(1000, kEnoughGb).memory_gb;
  EXPECT_NEAR(Estimate(1000, kEnoughGb, 11).memory_gb - one, 10 * 4 * kPixelsGb,
              1e-6);
  EXPECT_NEAR(one - Estimate(1000, 0.04).memory_gb, 4 * kPixelsGb - 0.04, 1e-6);
  EXPECT_GT(Estimate(1000, kEnoughGb).thread_gb, 4 * kPixelsGb);
  EXPECT_GT(Estimate(1000, kEnoughGb, 11).core_seconds,
            Estimate(1000, kEnoughGb).core_seconds);
}

}  // namespace colmap_ext::refinement_estimate_test
