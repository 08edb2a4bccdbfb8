#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "optim/potts_mrf.h"
#include "optim/sweep_order.h"
#include "tests/optim/graphs.h"
#include "tests/optim/random_potts.h"

namespace colmap_ext {
namespace potts_mrf_test {

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

TEST(SolvePotts, IsExactOnChains) {
  for (uint32_t seed = 0; seed < 20; ++seed) {
    const PottsProblem problem = RandomProblem(8, Chain(8), 4, 0.8, 0.6, seed);
    const PottsSolution solution = SolvePotts(problem, 0, 50);
    EXPECT_NEAR(solution.energy, BruteForce(problem), 1e-4) << seed;
  }
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
    const PottsProblem problem = LargeWall(weight);
    const PottsSolution solution = SolvePotts(problem);
    EXPECT_LE(solution.energy, 1.02 * solution.lower_bound) << weight;
    EXPECT_LE(solution.energy, solution.initial_energy) << weight;
  }
}

TEST(SolvePotts, DoesNotDependOnTheNumberOfThreads) {
  const PottsProblem problem = LargeWall(0.7);
  std::vector<PottsSolution> solutions;
  for (const int num_threads : {1, 2, 3}) {
    const tbb::global_control control(
        tbb::global_control::max_allowed_parallelism, num_threads);
    solutions.push_back(SolvePotts(problem));
    EXPECT_EQ(solutions.back().choices, solutions[0].choices);
    EXPECT_EQ(solutions.back().energy, solutions[0].energy);
    EXPECT_EQ(solutions.back().lower_bound, solutions[0].lower_bound);
  }
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

TEST(SolvePotts, TakesTheCheapestLabelsWhereNeighborsDoNotMatter) {
  const PottsProblem problem = RandomProblem(200, Prism(100), 9, 0.5, 0, 3);
  const PottsSolution solution = SolvePotts(problem);
  EXPECT_NEAR(solution.energy, solution.initial_energy, 1e-4);
}

TEST(SolvePotts, TakesOneLabelWhereNeighborsAreAll) {
  const PottsProblem problem = RandomProblem(200, Prism(100), 9, 1, 1e3, 3);
  const PottsSolution solution = SolvePotts(problem);
  EXPECT_EQ(std::count(solution.choices.begin(), solution.choices.end(),
                       solution.choices[0]),
            200);
}

TEST(SolvePotts, LeavesNodesWithoutLabelsOut) {
  PottsProblem problem;
  problem.neighbors = {{1, kNone, kNone}, {0, 2, kNone}, {1, kNone, kNone}};
  problem.offsets = {0, 2, 2, 3};
  problem.labels = {4, 8, 8};
  problem.costs = {1, 2, 3};
  problem.weight = 100;
  const PottsSolution solution = SolvePotts(problem);
  EXPECT_EQ(solution.choices, (std::vector<uint32_t>{0, kNone, 0}));
  EXPECT_DOUBLE_EQ(solution.energy, 4);
}

TEST(SolvePotts, SolvesNothing) { EXPECT_TRUE(SolvePotts({}).choices.empty()); }

}  // namespace potts_mrf_test
}  // namespace colmap_ext
