#include "meshing/finish_surface.h"

#include <gtest/gtest.h>

namespace colmap_ext {
namespace finish_surface_test {

TEST(SupportOfVertices, AddsUpThePointsOfEach) {
  EXPECT_EQ(SupportOfVertices(3, {0, 2, 0, 2}, {1, 2, 4, 8}),
            (std::vector<float>{5, 0, 10}));
}

TEST(MeansOfSources, IsTheMeanOfBoth) {
  EXPECT_EQ(MeansOfSources({1, 3}, {{0, 0}, {0, 1}, {2, 2}, {1, 2}}, 7),
            (std::vector<float>{1, 2, 7, 5}));
}

}  // namespace finish_surface_test
}  // namespace colmap_ext
