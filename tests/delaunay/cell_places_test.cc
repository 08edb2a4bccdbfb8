#include "delaunay/cell_places.h"

#include <map>

#include <gtest/gtest.h>

#include "tests/random.h"

namespace colmap_ext {
namespace cell_places_test {

TEST(CellPlaces, AreThoseOfAMap) {
  Random random(1);
  CellPlaces places;
  size_t num_repeats = 0;
  for (const uint32_t num_cells : {1, 5, 63, 64, 65, 3000, 20, 1}) {
    places.Clear();
    std::vector<uint32_t> cells;
    std::map<uint32_t, uint32_t> expected;
    for (uint32_t step = 0; step < 3 * num_cells; ++step) {
      // Also those that differ in their upper bits alone.
      const uint32_t cell = random.Below(num_cells) << random.Below(24);
      const auto [entry, is_new] =
          expected.try_emplace(cell, static_cast<uint32_t>(cells.size()));
      ASSERT_EQ(places.PlaceIn(cell, &cells), entry->second);
      ASSERT_EQ(cells.size(), expected.size());
      ASSERT_EQ(cells[entry->second], cell);
      num_repeats += !is_new;
    }
  }
  EXPECT_GT(num_repeats, 100u);
}

}  // namespace cell_places_test
}  // namespace colmap_ext
