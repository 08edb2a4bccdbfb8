#include <algorithm>
#include <numeric>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "tests/optim/random_potts.h"

namespace colmap_ext {
namespace sweep_order_test {

// The graph, its nodes in the order of the sweep.
Neighbors Sorted(uint32_t num_nodes, const Edges& edges) {
  const std::vector<uint32_t> order =
      SweepOrder(MakeNeighbors(num_nodes, edges));
  std::vector<uint32_t> sorted = order;
  std::sort(sorted.begin(), sorted.end());
  std::vector<uint32_t> all(num_nodes);
  std::iota(all.begin(), all.end(), 0);
  EXPECT_EQ(sorted, all);
  return MakeNeighbors(num_nodes, Renumber(edges, order));
}

// Nodes without a neighbor before them.
uint32_t NumStarts(const Neighbors& neighbors) {
  uint32_t num_starts = 0;
  for (uint32_t i = 0; i < neighbors.size(); ++i) {
    const auto& row = neighbors[i];
    num_starts += *std::min_element(row.begin(), row.end()) > i ? 1 : 0;
  }
  return num_starts;
}

// Runs of nodes that are not neighbors, as few as there can be.
uint32_t NumRuns(const Neighbors& neighbors) {
  uint32_t num_runs = 1;
  uint32_t first = 0;  // of the run
  for (uint32_t i = 0; i < neighbors.size(); ++i) {
    for (const uint32_t other : neighbors[i]) {
      if (other >= first && other < i) {
        first = i;
        ++num_runs;
      }
    }
  }
  return num_runs;
}

// The edges of several such graphs of `size` nodes.
Edges Copies(const Edges& edges, uint32_t size, uint32_t count) {
  Edges copies;
  for (uint32_t i = 0; i < count; ++i) {
    for (const auto& [a, b] : edges) {
      copies.push_back({i * size + a, i * size + b});
    }
  }
  return copies;
}

TEST(SweepOrder, GoesThroughAWallInDiagonals) {
  const Neighbors sorted = Sorted(10000, Wall(100));
  EXPECT_EQ(NumStarts(sorted), 1);
  EXPECT_LE(NumRuns(sorted), 299);  // to the far corner
}

TEST(SweepOrder, TakesNeighborsOfTheSameLevelApart) {
  const Neighbors sorted = Sorted(202, Prism(101));
  EXPECT_EQ(NumStarts(sorted), 1);
  EXPECT_LE(NumRuns(sorted), 2 * 52);
}

TEST(SweepOrder, GoesThroughPartsSideBySide) {
  const Neighbors sorted = Sorted(800, Copies(Prism(4), 8, 100));
  EXPECT_EQ(NumStarts(sorted), 100);
  EXPECT_LE(NumRuns(sorted), 8);
}

TEST(SweepOrder, ReachesAllWhateverTheNumbering) {
  std::mt19937 random(5);
  std::vector<uint32_t> order(2500);
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), random);
  const Neighbors sorted = Sorted(2500, Renumber(Wall(50), order));
  EXPECT_EQ(NumStarts(sorted), 1);
  EXPECT_LE(NumRuns(sorted), 4 * 150);
}

TEST(SweepOrder, OrdersNothing) {
  EXPECT_TRUE(SweepOrder({}).empty());
  EXPECT_EQ(NumRuns(Sorted(3, {})), 1);
}

}  // namespace sweep_order_test
}  // namespace colmap_ext
