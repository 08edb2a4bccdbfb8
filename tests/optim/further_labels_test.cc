#include "optim/further_labels.h"

#include <algorithm>
#include <numeric>
#include <ranges>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "optim/sweep_order.h"
#include "tests/optim/graphs.h"
#include "tests/optim/random_potts.h"

namespace colmap_ext {
namespace further_labels_test {

// A wall of 2,500 nodes, most with more than 4 labels of 10.
PottsProblem MakeProblem(double weight) {
  return RandomProblem(2500, Wall(50), 10, 0.7, weight, 3);
}

LabelSets Choose(const PottsProblem& problem) {
  return ChosenLabels(problem, SolvePotts(problem).choices);
}

bool Contains(std::span<const uint32_t> labels, uint32_t label) {
  return std::ranges::find(labels, label) != labels.end();
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
        if (other != kNone && !Contains(sets[other], label)) {
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
      EXPECT_TRUE(
          std::includes(own.begin(), own.end(), labels.begin(), labels.end()));
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
  const LabelSets chosen = Choose(problem);
  const LabelSets sets = AddFurtherLabels(problem, chosen, 4);
  for (uint32_t node = 0; node < problem.NumNodes(); ++node) {
    std::vector<std::pair<float, uint32_t>> row;
    for (uint32_t i = 0; i < problem.NumLabels(node); ++i) {
      row.emplace_back(problem.Costs(node)[i], problem.Labels(node)[i]);
    }
    std::sort(row.begin(), row.end());
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
  const LabelSets expected = AddFurtherLabels(problem, chosen, 4);
  for (const int num_threads : {1, 2, 3}) {
    const tbb::global_control control(
        tbb::global_control::max_allowed_parallelism, num_threads);
    EXPECT_EQ(AddFurtherLabels(problem, chosen, 4), expected);
  }
}

}  // namespace further_labels_test
}  // namespace colmap_ext
