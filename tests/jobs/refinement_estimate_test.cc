#include "colmap_ext/jobs/refinement_estimate.h"

#include <gtest/gtest.h>

#include "base/indices.h"
#include "colmap_ext/terminal/terminal.h"
#include "tests/mesh/known_meshes.h"

namespace colmap_ext::refinement_estimate_test {

constexpr double kEnoughGb = 1e3;
constexpr uint32_t kNumQuads = 8;  // along each side, one scene unit each

// A sheet ten units before cameras whose pixels are 10 / focal_length of a unit
// on it.
RefinementTile Estimate(double focal_length, double max_memory_gb,
                        size_t num_views = 2, double max_face_area = 7,
                        RefinerOptions options = {}) {
  Surface surface{MakeSheet(kNumQuads, kNumQuads), {}};
  for (size_t i = 0; i < surface.mesh.vertices.size(); ++i) {
    surface.attributes.views.AddRow(Iota(static_cast<uint32_t>(num_views)));
  }
  View view{"", 4000, 3000};
  view.fx = view.fy = focal_length;
  view.cam_from_world_translation.z() = 10;
  options.max_memory_gb = max_memory_gb;
  options.refinement.max_face_area = max_face_area;
  return EstimateRun(surface, std::vector<View>(num_views, view), options);
}

TEST(EstimateRun, TakesTheFacetsOfTheFinestLevel) {
  const double usual = Estimate(1000, kEnoughGb).facets;
  EXPECT_NEAR(Estimate(2000, kEnoughGb).facets / usual, 4, 1e-3);
  EXPECT_NEAR(Estimate(1000, kEnoughGb, 2, 3.5).facets / usual, 2, 1e-3);
  // A sheet is flat: its facets get nine times as large as they may be small.
  constexpr double kSide = 100.0 * kNumQuads;  // px
  EXPECT_NEAR(usual, kSide * kSide / 7 / 9, 0.01 * usual);
  // A facet of the input takes 0.4 of the memory of a refined one, at least.
  constexpr double kInput = 0.4 * 2 * kNumQuads * kNumQuads;
  EXPECT_DOUBLE_EQ(Estimate(1, kEnoughGb).facets, kInput);
  // What one view sees is not refined.
  EXPECT_DOUBLE_EQ(Estimate(1000, kEnoughGb, 1).facets, kInput);
}

TEST(EstimateRun, TakesImagesUpToWhatIsKeptAndOneForEachThread) {
  constexpr double kPixelsGb = 4000 * 3000 * 1e-9;  // a byte for each
  const RefinementTile two = Estimate(1000, kEnoughGb);
  EXPECT_NEAR(Estimate(1000, kEnoughGb, 12).memory_gb - two.memory_gb,
              10 * 4 * kPixelsGb, 1e-6);
  const RefinementTile less = Estimate(1000, 0.04);
  EXPECT_NEAR(two.memory_gb - less.memory_gb, 2 * 4 * kPixelsGb - less.cache_gb,
              1e-6);
  EXPECT_GT(two.thread_gb, 4 * kPixelsGb);
  EXPECT_GT(less.thread_gb, two.thread_gb);
  EXPECT_GT(Estimate(1000, kEnoughGb, 12).core_seconds, two.core_seconds);
}

TEST(EstimateRun, TakesLessTimeForLessWork) {
  const auto seconds = [](int levels, int iterations, int final_pairs) {
    RefinerOptions options;
    options.refinement.levels = levels;
    options.refinement.iterations = iterations;
    options.refinement.labeling.final_pairs_per_facet = final_pairs;
    return Estimate(1000, kEnoughGb, 2, 7, options).core_seconds;
  };
  const double usual = Estimate(1000, kEnoughGb).core_seconds;
  EXPECT_NEAR(seconds(3, 10, 18) / usual, 1, 0.02);
  // As measured (docs/experiments.md, "Time by options").
  EXPECT_NEAR(seconds(1, 10, 18) / usual, 0.77, 0.05);
  EXPECT_NEAR(seconds(3, 3, 18) / usual, 0.85, 0.05);
  EXPECT_NEAR(seconds(3, 10, 0) / usual, 0.70, 0.05);
  EXPECT_NEAR(seconds(3, 1000, 18) / usual, 1, 0.02);
}

TEST(MaxMemoryGb, IsAPartOfTheMachine) {
  const double machine = MaxMemoryGb({});
  EXPECT_GT(machine, 0.1);
  EXPECT_LT(machine, 1e-9 * static_cast<double>(MachineMemory()));
  RefinerOptions options;
  options.max_memory_gb = 3;
  EXPECT_EQ(MaxMemoryGb(options), 3);
}

}  // namespace colmap_ext::refinement_estimate_test
