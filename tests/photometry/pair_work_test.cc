#include "photometry/pair_work.h"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include <gtest/gtest.h>

#include "base/lru_cache.h"
#include "tests/look_at.h"
#include "tests/mesh/known_meshes.h"
#include "tests/peak_memory.h"
#include "tests/refine/refinement_scene.h"

namespace colmap_ext::pair_work_test {

constexpr uint32_t kNumViews = 4;

// Up to three of the pairs of four views for each facet, compared in one
// direction or both.
FacetLabels RandomLabels(uint32_t num_facets, Random* random) {
  FacetLabels labels{AllPairs(kNumViews), {}, {}};
  std::vector<uint32_t> all = Iota(labels.pairs.size());
  for (uint32_t i = 0; i < num_facets; ++i) {
    random->Shuffle(&all);
    labels.labels.AddRow(std::span(all).first(random->Below(4)));
  }
  for (size_t i = 0; i < labels.labels.values.size(); ++i) {
    labels.directions.push_back(random->Integer(kInFirst, kBothDirections));
  }
  return labels;
}

// Whether a facet is compared in a direction.
bool IsCompared(const FacetLabels& labels, uint32_t facet, uint32_t direction) {
  for (uint64_t i = labels.labels.offsets[facet];
       i < labels.labels.offsets[facet + 1]; ++i) {
    if (labels.labels.values[i] == direction / 2 &&
        (labels.directions[i] & (direction % 2 == 0 ? kInFirst : kInSecond)) !=
            0) {
      return true;
    }
  }
  return false;
}

// Patches of facets, and places without any.
FacetIdBuffer RandomBuffer(int width, int height, uint32_t num_facets,
                           Random* random) {
  FacetIdBuffer buffer;
  buffer.width = width;
  buffer.height = height;
  buffer.facets = FacetIds(static_cast<size_t>(width) * height, num_facets);
  for (uint32_t facet = 0; facet < num_facets; ++facet) {
    const int row = random->Integer(0, height - 1);
    const int col = random->Integer(0, width - 1);
    const int size = random->Integer(1, 20);
    for (int y = row; y < std::min(row + size, height); ++y) {
      for (int x = col; x < std::min(col + size, width); ++x) {
        buffer.facets.Set(buffer.Index(y, x), facet);
      }
    }
  }
  return buffer;
}

TEST(GroupByDirection, TurnsTheLabelsRoundInBothUnlessToldOtherwise) {
  Random random(1);
  for (const uint32_t num_facets : {0u, 1u, 5u, 300u}) {
    const FacetLabels labels = RandomLabels(num_facets, &random);
    const Rows<uint32_t> by_direction = GroupByDirection(labels);
    ASSERT_EQ(by_direction.size(), 2 * labels.pairs.size());
    for (uint32_t direction = 0; direction < by_direction.size(); ++direction) {
      std::vector<uint32_t> expected;
      for (uint32_t facet = 0; facet < num_facets; ++facet) {
        if (IsCompared(labels, facet, direction)) {
          expected.push_back(facet);
        }
      }
      const auto facets = by_direction[direction];
      EXPECT_EQ(std::vector<uint32_t>(facets.begin(), facets.end()), expected);
    }
  }
  FacetLabels labels = RandomLabels(40, &random);
  std::ranges::fill(labels.directions, kBothDirections);
  const Rows<uint32_t> told = GroupByDirection(labels);
  labels.directions.clear();
  EXPECT_EQ(GroupByDirection(labels), told);
}

TEST(AreGroupsOf, OnlyTheSameFacetsInTheSameDirections) {
  Random random(2);
  for (const uint32_t num_facets : {0u, 1u, 5u, 300u}) {
    FacetLabels labels = RandomLabels(num_facets, &random);
    const Rows<uint32_t> groups = GroupByDirection(labels);
    EXPECT_TRUE(AreGroupsOf(labels, groups));
    FacetLabels more = labels;
    more.pairs.push_back({0, 1});
    EXPECT_FALSE(AreGroupsOf(more, groups));
    for (size_t i = 0; i < labels.directions.size(); ++i) {
      FacetLabels other = labels;
      other.directions[i] ^= kInSecond;
      EXPECT_FALSE(AreGroupsOf(other, groups));
    }
    labels.KeepOf(std::vector<uint8_t>(num_facets, 0));
    EXPECT_EQ(AreGroupsOf(labels, groups), groups.values.empty());
  }
}

// The squares with pixels of a direction, and the rectangles around those.
using Squares = std::map<std::pair<int, int>, std::array<int, 4>>;

Squares ExpectedSquares(const FacetIdBuffer& drawn, const FacetLabels& labels,
                        uint32_t direction) {
  Squares squares;
  ForEachPixel(drawn, [&](int row, int col) {
    const uint32_t facet = drawn.facets[drawn.Index(row, col)];
    if (facet == kNone || !IsCompared(labels, facet, direction)) {
      return;
    }
    auto& [first_row, last_row, first_col, last_col] =
        squares
            .try_emplace({row / kTileSize, col / kTileSize},
                         std::array<int, 4>{row, row, col, col})
            .first->second;
    first_row = std::min(first_row, row);
    last_row = std::max(last_row, row);
    first_col = std::min(first_col, col);
    last_col = std::max(last_col, col);
  });
  return squares;
}

TEST(FindTiles, AreTheSmallestRectanglesInEachSquareThatHasAny) {
  Random random(3);
  for (const auto& [width, height] :
       {std::pair(1, 1), {kTileSize, kTileSize}, {101, 70}, {33, 95}}) {
    const uint32_t num_facets = 12;
    const FacetLabels labels = RandomLabels(num_facets, &random);
    const FacetIdBuffer drawn =
        RandomBuffer(width, height, num_facets, &random);
    const auto of_views = DirectionsOfViews(labels.pairs, kNumViews);
    EXPECT_EQ(of_views.values.size(), 2 * labels.pairs.size());
    for (uint32_t view = 0; view < kNumViews; ++view) {
      const auto tiles = FindTiles(drawn, of_views[view], labels);
      ASSERT_EQ(tiles.size(), of_views[view].size());
      for (size_t k = 0; k < tiles.size(); ++k) {
        const uint32_t direction = of_views[view][k];
        const auto [first, second] = labels.pairs[direction / 2];
        EXPECT_EQ(direction % 2 == 0 ? first : second, view);
        Squares squares;
        for (const PixelBox& tile : tiles[k]) {
          EXPECT_EQ(tile.first_row / kTileSize, tile.last_row / kTileSize);
          EXPECT_EQ(tile.first_col / kTileSize, tile.last_col / kTileSize);
          EXPECT_TRUE(
              squares
                  .try_emplace(
                      {tile.first_row / kTileSize, tile.first_col / kTileSize},
                      std::array<int, 4>{tile.first_row, tile.last_row,
                                         tile.first_col, tile.last_col})
                  .second);
        }
        EXPECT_EQ(squares, ExpectedSquares(drawn, labels, direction));
      }
    }
  }
  const FacetLabels labels = RandomLabels(5, &random);
  for (const auto& tiles :
       FindTiles(RandomBuffer(64, 64, 0, &random),
                 DirectionsOfViews(labels.pairs, kNumViews)[0], labels)) {
    EXPECT_TRUE(tiles.empty());
  }
}

// Each thread has one.
TEST(FacetPlaces, TakeLittleMemoryForEachFacet) {
  constexpr size_t kNumFacets = 32000000;
  const size_t before = PeakMemory();
  const FacetPlaces places(kNumFacets);
  EXPECT_LT(PeakMemory() - before, kNumFacets / 2);
}

TEST(FacetPlaces, AreThoseInTheList) {
  Random random(2);
  FacetPlaces places(1000);
  for (int trial = 0; trial < 10; ++trial) {
    std::vector<uint32_t> facets;
    for (uint32_t i = 0; i < 1000; ++i) {
      if (random.Below(10) < static_cast<uint32_t>(trial)) {
        facets.push_back(i);
      }
    }
    places.Set(facets);
    for (uint32_t i = 0, k = 0; i < 1000; ++i) {
      const bool is_there = k < facets.size() && facets[k] == i;
      ASSERT_EQ(places.Has(i), is_there);
      if (is_there) {
        ASSERT_EQ(places[i], k++);
      }
    }
    places.Clear(facets);
  }
}

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
  const std::vector<uint32_t> names = random->Permutation(partners.size());
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
      const uint32_t partner = random.Below(partners.size());
      partners[random.Below(partners.size())].insert(partner);
    }
    for (uint32_t k = 0; k < partners.size(); ++k) {
      partners[k].erase(k);
    }
    EXPECT_TRUE(std::ranges::is_permutation(OrderByPartners(RowsOf(partners)),
                                            Iota(partners.size())));
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

TEST(FindDirections, ShareOutAllTilesInParts) {
  const TriangleMesh mesh = MakeSheet(8, 10);
  std::vector<View> views;
  for (const double x : {4.5, 5.5}) {
    views.push_back(LookAt({x, 4, 8}, {5, 4, 0}, 1000, 800, 900));
  }
  const VisibilityBuffers buffers(mesh, views, 0.1, SIZE_MAX);
  FacetLabels labels{AllPairs(2), {}, {}};
  for (uint32_t facet = 0; facet < mesh.facets.size(); ++facet) {
    labels.labels.AddRow(std::vector<uint32_t>(facet % 5 != 0 ? 1 : 0));
  }
  const std::vector<TiledDirection> parts = FindDirections(buffers, labels);
  EXPECT_GE(parts.size(), 4u);
  std::map<uint32_t, std::vector<PixelBox>> tiles;
  for (const TiledDirection& part : parts) {
    EXPECT_EQ(part.direction, part.i);
    EXPECT_EQ(part.j, 1 - part.i);
    EXPECT_GT(part.tiles.size(), 0u);
    EXPECT_LE(part.tiles.size(), kMaxTiles);
    Append(part.tiles, &tiles[part.direction]);
  }
  for (const uint32_t direction : {0u, 1u}) {
    const auto expected =
        FindTiles(*buffers.Get(direction), std::vector{direction}, labels);
    EXPECT_GT(expected[0].size(), kMaxTiles);
    EXPECT_TRUE(std::ranges::equal(
        tiles[direction], expected[0],
        [](const PixelBox& a, const PixelBox& b) {
          return std::tie(a.first_row, a.last_row, a.first_col, a.last_col) ==
                 std::tie(b.first_row, b.last_row, b.first_col, b.last_col);
        }));
  }
}

}  // namespace colmap_ext::pair_work_test
