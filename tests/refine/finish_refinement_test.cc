#include "refine/facetwise_refinement.h"

#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/mesh/shapes.h"

namespace colmap_ext {
namespace finish_refinement_test {

TEST(FinishRefinement, RefusesRegionsThatLeaveNothing) {
  FacetwiseRefinementOptions options;
  options.region = RegionBetween({9, 9, 9}, {10, 10, 10});
  RefinedMesh refined;
  refined.mesh = MakeCube();
  refined.attributes.views.offsets.assign(refined.mesh.vertices.size() + 1, 0);
  refined.report.is_skipped = true;
  EXPECT_THROW(FinishRefinement(options, {}, &refined), std::invalid_argument);
}

}  // namespace finish_refinement_test
}  // namespace colmap_ext
