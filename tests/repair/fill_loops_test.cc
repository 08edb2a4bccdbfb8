#include "repair/fill_loops.h"

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <new>
#include <numbers>

#include <gtest/gtest.h>
#ifdef __SANITIZE_ADDRESS__
#include <sanitizer/lsan_interface.h>
#endif

#include "tests/mesh/known_meshes.h"

namespace {

constexpr int64_t kEndless = std::numeric_limits<int64_t>::max();

// Until memory is used up, of this thread.
thread_local int64_t allocations_left = kEndless;

}  // namespace

[[gnu::noinline]] void* operator new(std::size_t size) {
  if (allocations_left-- > 0) {
    if (void* memory = std::malloc(size)) {
      return memory;
    }
  }
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory,
                                       std::size_t /*size*/) noexcept {
  std::free(memory);
}

namespace colmap_ext {
namespace {

// Facets between two hexagons, around a hole.
TriangleMesh MakeRing() {
  return Moved(MakeSheet(1, 6, false, true), [](const Eigen::Vector3f& p) {
    const float angle = p.x() * std::numbers::pi_v<float> / 3;
    const float radius = p.y() + 1;
    return Eigen::Vector3f(radius * std::cos(angle), radius * std::sin(angle),
                           0);
  });
}

// A loop that memory does not suffice for is not one that cannot be closed,
// whichever allocation fails.
TEST(FillLoop, ThrowsWhereTheMemoryDoesNotSuffice) {
#ifdef __SANITIZE_ADDRESS__
  // CGAL's constructors lose what they have when memory runs out.
  const __lsan::ScopedDisabler disabler;
#endif
  const TriangleMesh mesh = MakeRing();
  const VertexRings rings = MakeVertexRings(mesh);
  const BorderLoop loop = {0, 1, 2, 3, 4, 5};
  for (const FillingKind kind :
       {FillingKind::kFair, FillingKind::kRefined, FillingKind::kFlat}) {
    allocations_left = kEndless;
    const auto expected = FillLoop(kind, mesh, rings, loop);
    const int64_t num_allocations = kEndless - allocations_left;
    ASSERT_TRUE(expected);
    int num_thrown = 0;
    for (int64_t n = 0; n <= num_allocations; n += 1 + num_allocations / 100) {
      allocations_left = n;
      std::optional<LoopFilling> filling;
      try {
        filling = FillLoop(kind, mesh, rings, loop);
        allocations_left = kEndless;
        ASSERT_TRUE(filling) << n;
        EXPECT_EQ(filling->facets, expected->facets);
      } catch (const std::bad_alloc&) {
        allocations_left = kEndless;
        ++num_thrown;
      }
    }
    EXPECT_GT(num_thrown, 30);
  }
}

}  // namespace
}  // namespace colmap_ext
