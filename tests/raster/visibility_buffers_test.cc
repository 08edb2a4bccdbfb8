#include "raster/visibility_buffers.h"

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include "tests/look_at.h"
#include "tests/mesh/shapes.h"

namespace colmap_ext {
namespace visibility_buffers_test {

std::vector<View> Views() {
  return {LookAt({0, 0.5, 4}, {0, 0, 0}, 60, 40, 60),
          LookAt({4, 0, 0.4}, {0, 0, 0}, 50, 40, 60),
          LookAt({-3, 1, -2}, {0, 0, 0}, 40, 40, 60)};
}

// Whatever the memory and whoever asks.
TEST(VisibilityBuffers, AreThoseOfDrawFacets) {
  const TriangleMesh mesh = MakeBumpySphere(0.3f);
  for (const size_t max_memory : {size_t{0}, size_t{30000}, SIZE_MAX}) {
    const VisibilityBuffers buffers(mesh, Views(), 0.1, max_memory);
    buffers.DrawAhead();
    tbb::parallel_for(0, 12, [&](int i) {
      const FacetIdBuffer expected = DrawFacets(Views()[i % 3], mesh, 0.1);
      const auto drawn = buffers.Get(i % 3);
      EXPECT_EQ(drawn->facets, expected.facets);
      EXPECT_EQ(drawn->inverse_depths, expected.inverse_depths);
      EXPECT_EQ(drawn->is_facing, expected.is_facing);
    });
  }
}

TEST(VisibilityBuffers, AreKeptWhereThereIsRoom) {
  const VisibilityBuffers kept(MakeBumpySphere(0.3f), Views(), 0.1, SIZE_MAX);
  const std::weak_ptr<const FacetIdBuffer> first = kept.Get(0);
  kept.Get(1);
  EXPECT_EQ(kept.Get(0), first.lock());
  const VisibilityBuffers dropped(MakeBumpySphere(0.3f), Views(), 0.1, 0);
  const std::weak_ptr<const FacetIdBuffer> second = dropped.Get(0);
  dropped.Get(1);
  EXPECT_TRUE(second.expired());
}

}  // namespace visibility_buffers_test
}  // namespace colmap_ext
