#include "refine/vertex_pixels.h"

#include <gtest/gtest.h>

#include "mesh/adjacency.h"

namespace colmap_ext {
namespace vertex_pixels_test {

// At the origin, along z, and one that is two units farther back.
std::vector<View> Views() {
  View view;
  view.fx = view.fy = 100;
  View behind = view;
  behind.cam_from_world_translation.z() = 2;
  return {view, behind};
}

TEST(VertexFootprints, AreOfTheViewsThatAVertexLiesBefore) {
  const TriangleMesh mesh = {{{0, 0, 4}, {1, 0, 2}, {0, 1, -1}}, {{0, 1, 2}}};
  FacetLabels labels{{{0, 1}}, {}, {}};
  labels.labels.AddRow(std::vector<uint32_t>{0});
  const std::vector<float> footprints =
      VertexFootprints(mesh, MakeVertexRings(mesh), labels, Views());
  EXPECT_FLOAT_EQ(footprints[0], 0.05F);
  EXPECT_FLOAT_EQ(footprints[1], 0.03F);
  EXPECT_FLOAT_EQ(footprints[2], 0.01F);
}

}  // namespace vertex_pixels_test
}  // namespace colmap_ext
