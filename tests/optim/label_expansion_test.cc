#include <algorithm>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "optim/label_expansion.h"
#include "tests/optim/random_potts.h"

namespace colmap_ext {
namespace label_expansion_test {

std::vector<uint32_t> FirstChoices(const PottsProblem& problem) {
  std::vector<uint32_t> choices(problem.NumNodes(), kNone);
  for (uint32_t node = 0; node < problem.NumNodes(); ++node) {
    choices[node] = problem.NumLabels(node) > 0 ? 0 : kNone;
  }
  return choices;
}

// The least energy of all choices in which some nodes, a bit each, have taken
// the label.
double LeastOfExpansions(const PottsProblem& problem, uint32_t label,
                         const std::vector<uint32_t>& choices) {
  double least = PottsEnergy(problem, choices);
  for (uint32_t takers = 0; takers < 1U << problem.NumNodes(); ++takers) {
    std::vector<uint32_t> expanded = choices;
    for (uint32_t node = 0; node < problem.NumNodes(); ++node) {
      const auto labels = problem.Labels(node);
      const auto at = std::ranges::find(labels, label);
      if ((takers >> node & 1) != 0 && at != labels.end()) {
        expanded[node] = static_cast<uint32_t>(at - labels.begin());
      }
    }
    least = std::min(least, PottsEnergy(problem, expanded));
  }
  return least;
}

TEST(ExpandLabels, IsExactForTwoLabels) {
  for (uint32_t seed = 0; seed < 40; ++seed) {
    const PottsProblem problem =
        RandomProblem(10, Prism(5), 2, 1, 0.05 * seed, seed);
    const std::vector<uint32_t> choices =
        ExpandLabels(problem, FirstChoices(problem));
    EXPECT_NEAR(PottsEnergy(problem, choices), BruteForce(problem), 1e-5);
  }
}

TEST(ExpandLabels, EndsWhereNoExpansionHelps) {
  for (uint32_t seed = 0; seed < 40; ++seed) {
    constexpr uint32_t kNumLabels = 5;
    const PottsProblem problem =
        RandomProblem(8, Prism(4), kNumLabels, 0.7, 0.05 * seed, seed);
    std::vector<uint32_t> choices = FirstChoices(problem);
    for (std::vector<uint32_t> before; before != choices;) {
      before = choices;
      choices = ExpandLabels(problem, before);
      EXPECT_LE(PottsEnergy(problem, choices),
                PottsEnergy(problem, before) + 1e-5);
    }
    for (uint32_t label = 0; label < kNumLabels; ++label) {
      EXPECT_NEAR(PottsEnergy(problem, choices),
                  LeastOfExpansions(problem, label, choices), 1e-5);
    }
  }
}

// More nodes than a block has: 90,000.
PottsProblem ManyBlocks() {
  return RandomProblem(90000, Wall(300), 4, 0.8, 0.5, 7);
}

TEST(ExpandLabels, ComesCloseToTheBoundInBlocks) {
  const PottsProblem problem = ManyBlocks();
  const double bound = SolvePotts(problem).lower_bound;
  std::vector<uint32_t> choices = FirstChoices(problem);
  choices = ExpandLabels(problem, choices);
  EXPECT_LT(PottsEnergy(problem, choices), 1.03 * bound);
  const std::vector<uint32_t> again = ExpandLabels(problem, choices);
  EXPECT_LE(PottsEnergy(problem, again), PottsEnergy(problem, choices) + 1e-3);
}

TEST(ExpandLabels, GivesTheSameWithAnyNumberOfThreads) {
  const PottsProblem problem = ManyBlocks();
  const std::vector<uint32_t> choices =
      ExpandLabels(problem, FirstChoices(problem));
  const tbb::global_control one_thread(
      tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(ExpandLabels(problem, FirstChoices(problem)), choices);
}

TEST(ExpandLabels, ExpandsNothing) {
  EXPECT_TRUE(ExpandLabels({}, {}).empty());
  PottsProblem problem;
  problem.offsets = {0, 0};
  problem.neighbors = MakeNeighbors(1, {});
  EXPECT_EQ(ExpandLabels(problem, {kNone}), std::vector<uint32_t>{kNone});
}

}  // namespace label_expansion_test
}  // namespace colmap_ext
