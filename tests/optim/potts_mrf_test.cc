#include "optim/potts_mrf.h"

#include <algorithm>
#include <random>
#include <ranges>
#include <set>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/optim/random_potts.h"
#include "tests/random.h"
#include "tests/threads.h"

namespace colmap_ext::potts_mrf_test {

// The least energy of a BinaryTree, from the leaves to the root.
double LeastOfTree(const PottsProblem& problem) {
  std::vector<double> costs(problem.costs.begin(), problem.costs.end());
  const auto least = [&](uint32_t node) {
    return *std::min_element(
        costs.begin() + static_cast<ptrdiff_t>(problem.offsets[node]),
        costs.begin() + static_cast<ptrdiff_t>(problem.offsets[node + 1]));
  };
  double sum = 0;
  for (auto node = static_cast<uint32_t>(problem.NumNodes()); node-- > 0;) {
    if (problem.NumLabels(node) == 0) {
      continue;
    }
    const uint32_t parent = (node - 1) / 2;
    if (node == 0 || problem.NumLabels(parent) == 0) {
      sum += least(node);
      continue;
    }
    uint64_t i = problem.offsets[node];
    for (uint64_t j = problem.offsets[parent]; j < problem.offsets[parent + 1];
         ++j) {
      while (i < problem.offsets[node + 1] &&
             problem.labels[i] < problem.labels[j]) {
        ++i;
      }
      const double other = least(node) + problem.weight;
      const bool is_common = i < problem.offsets[node + 1] &&
                             problem.labels[i] == problem.labels[j];
      costs[j] += is_common ? std::min(costs[i], other) : other;
    }
  }
  return sum;
}

// A wall of 40,000 nodes in the order of a sweep, whose runs are long enough to
// be cut.
PottsProblem LargeWall(double weight) {
  const Edges edges = Wall(200);
  const std::vector<uint32_t> order = SweepOrder(MakeNeighbors(40000, edges));
  return RandomProblem(40000, Renumber(edges, order), 30, 0.3, weight, 11);
}

TEST(SolvePotts, ComesCloseToTheLeastEnergy) {
  int num_exact = 0;
  for (uint32_t seed = 0; seed < 40; ++seed) {
    const PottsProblem problem =
        RandomProblem(8, Prism(4), 4, 0.7, 0.1 + 0.05 * seed, seed);
    const PottsSolution solution = SolvePotts(problem, 0, 50);
    const double least = BruteForce(problem);
    EXPECT_GE(solution.energy, least - 1e-5);
    EXPECT_LE(solution.energy, 1.1 * least + 1e-5) << seed;
    EXPECT_LE(solution.lower_bound, least + 1e-4) << seed;
    num_exact += solution.energy < least + 1e-5 ? 1 : 0;
  }
  EXPECT_GE(num_exact, 30);
}

TEST(SolvePotts, IsExactOnLargeTrees) {
  for (const double weight : {0.2, 1.0, 3.0}) {
    const PottsProblem problem =
        RandomProblem(4095, BinaryTree(4095), 12, 0.4, weight, 2);
    const double least = LeastOfTree(problem);
    const PottsSolution solution = SolvePotts(problem, 0, 100);
    EXPECT_NEAR(solution.energy, least, 1e-3 * least) << weight;
    EXPECT_NEAR(solution.lower_bound, least, 1e-3 * least) << weight;
    EXPECT_LE(solution.lower_bound, least * (1 + 1e-6)) << weight;
  }
}

TEST(SolvePotts, IsWithinTwoPercentOnALargeWall) {
  for (const double weight : {0.1, 0.7, 3.0}) {
    const PottsSolution solution = SolvePotts(LargeWall(weight));
    EXPECT_LE(solution.energy, 1.02 * solution.lower_bound) << weight;
    EXPECT_LE(solution.energy, solution.initial_energy) << weight;
  }
}

TEST(SolvePotts, DoesNotDependOnTheNumberOfThreads) {
  const PottsProblem problem = LargeWall(0.7);
  ExpectSameForAnyThreads([&] {
    PottsSolution solution = SolvePotts(problem);
    return std::tuple(std::move(solution.choices), solution.energy,
                      solution.lower_bound);
  });
}

TEST(SolvePotts, ReportsItsEnergies) {
  for (const double weight : {0.0, 0.3, 2.2}) {
    const PottsProblem problem =
        RandomProblem(4000, Prism(2000), 50, 0.3, weight, 7);
    const PottsSolution solution = SolvePotts(problem);
    EXPECT_DOUBLE_EQ(solution.energy, PottsEnergy(problem, solution.choices));
    EXPECT_LE(solution.energy, solution.initial_energy);
    EXPECT_LE(solution.lower_bound, solution.energy * (1 + 1e-6));
    EXPECT_GT(solution.lower_bound, 0);
    EXPECT_EQ(SolvePotts(problem).choices, solution.choices);
  }
}

TEST(SolvePotts, TakesTheCheapestLabelsOrOneWhereNeighborsAreNothingOrAll) {
  const PottsProblem problem = RandomProblem(200, Prism(100), 9, 0.5, 0, 3);
  const PottsSolution solution = SolvePotts(problem);
  EXPECT_NEAR(solution.energy, solution.initial_energy, 1e-4);
  const PottsProblem tight = RandomProblem(200, Prism(100), 9, 1, 1e3, 3);
  const PottsSolution one = SolvePotts(tight);
  EXPECT_EQ(std::ranges::count(one.choices, one.choices[0]), 200);
}

TEST(SolvePotts, LeavesNodesWithoutLabelsOutAndSolvesNothing) {
  PottsProblem problem;
  problem.neighbors = {{1, kNone, kNone}, {0, 2, kNone}, {1, kNone, kNone}};
  problem.offsets = {0, 2, 2, 3};
  problem.labels = {4, 8, 8};
  problem.costs = {1, 2, 3};
  problem.weight = 100;
  const PottsSolution solution = SolvePotts(problem);
  EXPECT_EQ(solution.choices, (std::vector<uint32_t>{0, kNone, 0}));
  EXPECT_DOUBLE_EQ(solution.energy, 4);
  EXPECT_TRUE(SolvePotts({}).choices.empty());
}

// A wall of 2,500 nodes, most with more than 4 labels of 10.
PottsProblem MakeProblem(double weight) {
  return RandomProblem(2500, Wall(50), 10, 0.7, weight, 3);
}

LabelSets Choose(const PottsProblem& problem) {
  return ChosenLabels(problem, SolvePotts(problem).choices);
}

std::set<uint32_t> SetOf(std::span<const uint32_t> labels) {
  return {labels.begin(), labels.end()};
}

// What the sets' labels after the first cost, a third of the weight for each
// neighbor without them counted.
double Cost(const PottsProblem& problem, const LabelSets& sets) {
  double sum = 0;
  for (uint32_t node = 0; node < problem.NumNodes(); ++node) {
    const auto own = problem.Labels(node);
    for (const uint32_t label : sets[node] | std::views::drop(1)) {
      sum += problem.Costs(node)[std::ranges::find(own, label) - own.begin()];
      for (const uint32_t other : problem.neighbors[node]) {
        if (other != kNone && std::ranges::count(sets[other], label) == 0) {
          sum += problem.weight / 3;
        }
      }
    }
  }
  return sum;
}

TEST(AddFurtherLabels, GivesEachNodeLabelsOfItsOwn) {
  const PottsProblem problem = MakeProblem(0.5);
  const LabelSets chosen = Choose(problem);
  for (const uint32_t count : {1, 2, 4, 20}) {
    const LabelSets sets = AddFurtherLabels(problem, chosen, count);
    ASSERT_EQ(sets.offsets.size(), problem.NumNodes() + 1);
    for (uint32_t node = 0; node < problem.NumNodes(); ++node) {
      const std::set<uint32_t> own = SetOf(problem.Labels(node));
      const std::set<uint32_t> labels = SetOf(sets[node]);
      EXPECT_EQ(labels.size(), std::min<size_t>(own.size(), count));
      EXPECT_EQ(labels.size(), sets[node].size());
      EXPECT_TRUE(std::ranges::includes(own, labels));
      if (!own.empty()) {
        EXPECT_EQ(sets[node][0], chosen[node][0]);
      }
    }
  }
}

TEST(AddFurtherLabels, KeepsTheGivenOnesFirst) {
  const PottsProblem problem = MakeProblem(0.5);
  const LabelSets few = AddFurtherLabels(problem, Choose(problem), 3);
  const LabelSets many = AddFurtherLabels(problem, few, 6);
  for (uint32_t node = 0; node < problem.NumNodes(); ++node) {
    EXPECT_TRUE(
        std::ranges::equal(few[node], many[node].first(few[node].size())));
    EXPECT_EQ(many[node].size(), std::min(problem.NumLabels(node), 6U));
    EXPECT_EQ(SetOf(many[node]).size(), many[node].size());
  }
  EXPECT_EQ(AddFurtherLabels(problem, few, 3), few);
}

TEST(AddFurtherLabels, TakesTheCheapestWhereNeighborsDoNotCount) {
  const PottsProblem problem = MakeProblem(0);
  const LabelSets sets = AddFurtherLabels(problem, Choose(problem), 4);
  for (uint32_t node = 0; node < problem.NumNodes(); ++node) {
    std::vector<std::pair<float, uint32_t>> row;
    for (uint32_t i = 0; i < problem.NumLabels(node); ++i) {
      row.emplace_back(problem.Costs(node)[i], problem.Labels(node)[i]);
    }
    std::ranges::sort(row);
    for (size_t i = 0; i < std::min<size_t>(row.size(), 4); ++i) {
      EXPECT_EQ(sets[node][i], row[i].second);
    }
  }
}

TEST(AddFurtherLabels, PrefersWhatNeighborsHave) {
  const PottsProblem problem = MakeProblem(6);
  const LabelSets chosen = Choose(problem);
  PottsProblem alone = problem;
  alone.weight = 0;
  const double cost = Cost(problem, AddFurtherLabels(problem, chosen, 4));
  EXPECT_LT(cost, 0.9 * Cost(problem, AddFurtherLabels(alone, chosen, 4)));
}

TEST(AddFurtherLabels, DoesNotDependOnThreads) {
  const PottsProblem problem = MakeProblem(0.5);
  const LabelSets chosen = Choose(problem);
  ExpectSameForAnyThreads([&] { return AddFurtherLabels(problem, chosen, 4); });
}

// The graph, its nodes in the order of the sweep.
Neighbors Sorted(uint32_t num_nodes, const Edges& edges) {
  const std::vector<uint32_t> order =
      SweepOrder(MakeNeighbors(num_nodes, edges));
  EXPECT_TRUE(std::ranges::is_permutation(order, Iota(num_nodes)));
  return MakeNeighbors(num_nodes, Renumber(edges, order));
}

// Nodes without a neighbor before them.
uint32_t NumStarts(const Neighbors& neighbors) {
  uint32_t num_starts = 0;
  for (uint32_t i = 0; i < neighbors.size(); ++i) {
    const auto& row = neighbors[i];
    num_starts += std::ranges::min(row) > i ? 1 : 0;
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

// A wall from five nodes, to the far corner; neighbors of the same level apart;
// and parts side by side.
TEST(SweepOrder, StartsFromASeedFor2048NodesAndOnceAPartAndTakesFewRuns) {
  for (const auto& [sorted, num_starts, max_runs] :
       {std::tuple(Sorted(10000, Wall(100)), 5u, 299u),
        {Sorted(202, Prism(101)), 1u, 2 * 52u},
        {Sorted(800, Copies(Prism(4), 8, 100)), 100u, 8u}}) {
    EXPECT_EQ(NumStarts(sorted), num_starts);
    EXPECT_LE(NumRuns(sorted), max_runs);
  }
}

TEST(SweepOrder, ReachesAllWhateverTheNumberingAndOrdersNothing) {
  std::mt19937 random(5);
  std::vector<uint32_t> order = Iota(2500);
  std::shuffle(order.begin(), order.end(), random);
  const Neighbors sorted = Sorted(2500, Renumber(Wall(50), order));
  EXPECT_EQ(NumStarts(sorted), 2);
  EXPECT_LE(NumRuns(sorted), 4 * 150);
  EXPECT_TRUE(SweepOrder({}).empty());
  EXPECT_EQ(NumRuns(Sorted(3, {})), 1);
}

}  // namespace colmap_ext::potts_mrf_test
