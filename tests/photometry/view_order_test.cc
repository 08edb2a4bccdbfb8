#include "photometry/view_order.h"

#include <algorithm>
#include <numeric>
#include <set>

#include <gtest/gtest.h>

#include "base/lru_cache.h"
#include "tests/random.h"

namespace colmap_ext {
namespace view_order_test {

using Partners = std::vector<std::set<uint32_t>>;

void Pair(uint32_t a, uint32_t b, Partners* partners) {
  (*partners)[a].insert(b);
  (*partners)[b].insert(a);
}

// Each view with the next two.
Partners Ring(uint32_t size) {
  Partners partners(size);
  for (uint32_t i = 0; i < size; ++i) {
    Pair(i, (i + 1) % size, &partners);
    Pair(i, (i + 2) % size, &partners);
  }
  return partners;
}

// Rows of `side` views over a plane.
Partners Grid(uint32_t side) {
  Partners partners(side * side);
  for (uint32_t i = 0; i < side * side; ++i) {
    if (i % side + 1 < side) {
      Pair(i, i + 1, &partners);
    }
    if (i + side < side * side) {
      Pair(i, i + side, &partners);
    }
  }
  return partners;
}

Partners Shuffled(const Partners& partners, Random* random) {
  std::vector<uint32_t> names(partners.size());
  std::iota(names.begin(), names.end(), 0);
  random->Shuffle(&names);
  Partners shuffled(partners.size());
  for (size_t i = 0; i < partners.size(); ++i) {
    for (const uint32_t partner : partners[i]) {
      shuffled[names[i]].insert(names[partner]);
    }
  }
  return shuffled;
}

Rows<uint32_t> RowsOf(const Partners& partners) {
  Rows<uint32_t> rows;
  for (const std::set<uint32_t>& row : partners) {
    rows.AddRow(row);
  }
  return rows;
}

// How often a view is read on average, where `room` views are kept.
double ReadsOfView(const Partners& partners, const std::vector<uint32_t>& order,
                   size_t room) {
  LruCache<const int> kept(room);
  double num_reads = 0;
  const auto read = [&] {
    ++num_reads;
    return std::make_shared<const int>(0);
  };
  for (const uint32_t view : order) {
    for (const uint32_t partner : partners[view]) {
      kept.Get(view, 1, read);
      kept.Get(partner, 1, read);
    }
  }
  return num_reads / static_cast<double>(order.size());
}

TEST(OrderByPartners, HasEachViewOnce) {
  Random random(1);
  for (int trial = 0; trial < 20; ++trial) {
    Partners partners(random.Below(60));
    for (uint32_t k = 0; k < partners.size(); ++k) {  // some have none
      partners[random.Below(partners.size())].insert(
          static_cast<uint32_t>(random.Below(partners.size())));
    }
    for (uint32_t k = 0; k < partners.size(); ++k) {
      partners[k].erase(k);
    }
    std::vector<uint32_t> order = OrderByPartners(RowsOf(partners));
    std::sort(order.begin(), order.end());
    std::vector<uint32_t> all(partners.size());
    std::iota(all.begin(), all.end(), 0);
    EXPECT_EQ(order, all);
  }
}

// Whatever order the images were taken in, or are named by.
TEST(OrderByPartners, ReadsFewViewsTwice) {
  constexpr size_t kRoom = 22;  // of 20 megapixels, in 4 GB
  Random random(2);
  const Partners ring = Ring(500);
  const Partners grid = Grid(22);
  for (const auto& [partners, bound] : {std::pair(ring, 1.05),
                                        {Shuffled(ring, &random), 1.15},
                                        {grid, 1.6},
                                        {Shuffled(grid, &random), 1.7}}) {
    const std::vector<uint32_t> order = OrderByPartners(RowsOf(partners));
    EXPECT_LT(ReadsOfView(partners, order, kRoom), bound);
  }
}

}  // namespace view_order_test
}  // namespace colmap_ext
