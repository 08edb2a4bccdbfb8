#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "optim/label_expansion.h"
#include "tests/optim/random_potts.h"

namespace colmap_ext {
namespace {

std::vector<uint32_t> FirstChoices(const PottsProblem& problem) {
  std::vector<uint32_t> choices(problem.NumNodes(), kNoChoice);
  for (uint32_t node = 0; node < problem.NumNodes(); ++node) {
    choices[node] = problem.NumLabels(node) > 0 ? 0 : kNoChoice;
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
      const uint32_t* labels = problem.Labels(node);
      const uint32_t* end = labels + problem.NumLabels(node);
      const uint32_t* at = std::find(labels, end, label);
      if ((takers >> node & 1) != 0 && at != end) {
        expanded[node] = static_cast<uint32_t>(at - labels);
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

TEST(ExpandLabels, ExpandsNothing) {
  EXPECT_TRUE(ExpandLabels({}, {}).empty());
  PottsProblem problem;
  problem.offsets = {0, 0};
  problem.neighbors = MakeNeighbors(1, {});
  EXPECT_EQ(ExpandLabels(problem, {kNoChoice}),
            std::vector<uint32_t>{kNoChoice});
}

}  // namespace
}  // namespace colmap_ext
