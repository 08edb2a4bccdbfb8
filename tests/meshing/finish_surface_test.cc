#include "meshing/finish_surface.h"

#include <gtest/gtest.h>

namespace colmap_ext {
namespace finish_surface_test {

TEST(SupportOfVertices, AddsUpThePointsOfEach) {
  EXPECT_EQ(SupportOfVertices(3, {0, 2, 0, 2}, {1, 2, 4, 8}),
            (std::vector<float>{5, 0, 10}));
}

TEST(SupportOfSurface, IsTheMeanOfTheSources) {
  EXPECT_EQ(SupportOfSurface({1, 3}, {{0, 0}, {0, 1}, {2, 2}, {1, 2}}),
            (std::vector<float>{1, 2, 0, 1.5f}));
}

}  // namespace finish_surface_test
}  // namespace colmap_ext
