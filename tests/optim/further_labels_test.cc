#include "optim/further_labels.h"

#include <algorithm>
#include <numeric>
#include <set>
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

// What the sets' labels after the first cost, a third of the weight for each
// neighbor without them counted.
double Cost(const PottsProblem& problem, const LabelSets& sets) {
  double sum = 0;
  for (uint32_t node = 0; node < problem.NumNodes(); ++node) {
    for (const uint32_t* label = sets.Labels(node) + 1;
         label < sets.Labels(node + 1); ++label) {
      const uint32_t* row = problem.Labels(node);
      sum += problem.Costs(
          node)[std::find(row, row + problem.NumLabels(node), *label) - row];
      for (const uint32_t other : problem.neighbors[node]) {
        if (other != kNone) {
          const uint32_t* end = sets.Labels(other + 1);
          sum += std::find(sets.Labels(other), end, *label) == end
                     ? problem.weight / 3
                     : 0;
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
      const std::set<uint32_t> own(problem.Labels(node),
                                   problem.Labels(node + 1));
      const std::set<uint32_t> labels(sets.Labels(node), sets.Labels(node + 1));
      EXPECT_EQ(labels.size(), std::min<size_t>(own.size(), count));
      EXPECT_EQ(labels.size(), sets.offsets[node + 1] - sets.offsets[node]);
      EXPECT_TRUE(
          std::includes(own.begin(), own.end(), labels.begin(), labels.end()));
      if (!own.empty()) {
        EXPECT_EQ(*sets.Labels(node), *chosen.Labels(node));
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
        std::equal(few.Labels(node), few.Labels(node + 1), many.Labels(node)));
    EXPECT_EQ(many.offsets[node + 1] - many.offsets[node],
              std::min(problem.NumLabels(node), 6U));
    EXPECT_EQ(
        std::set<uint32_t>(many.Labels(node), many.Labels(node + 1)).size(),
        many.offsets[node + 1] - many.offsets[node]);
  }
  EXPECT_EQ(AddFurtherLabels(problem, few, 3).labels, few.labels);
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
      EXPECT_EQ(sets.Labels(node)[i], row[i].second);
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
    EXPECT_EQ(AddFurtherLabels(problem, chosen, 4).labels, expected.labels);
  }
}

}  // namespace further_labels_test
}  // namespace colmap_ext
