#include "optim/further_labels.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include <tbb/parallel_for.h>

namespace colmap_ext {

namespace {

// A label of a node, by its place in the problem's.
using PricedLabel = std::pair<double, uint64_t>;

// How many of a node's neighbors have not got a label.
int NumWithout(const PottsProblem& problem, const LabelSets& sets,
               uint32_t node, uint32_t label) {
  int count = 0;
  for (const uint32_t neighbor : problem.neighbors[node]) {
    if (neighbor == UINT32_MAX) {
      continue;
    }
    const uint32_t* end = sets.Labels(neighbor + 1);
    count += std::find(sets.Labels(neighbor), end, label) == end ? 1 : 0;
  }
  return count;
}

// One half of the nodes, another one in each round: if all chose at once,
// neighbors would take each other's labels in turn for ever.
bool ChoosesIn(int round, uint32_t node) {
  // Bits that are well mixed (Knuth, multiplicative hashing).
  return ((node * 0x9e3779b1U) >> (31 - round) & 1) != 0;
}

// Into `labels`, where the node's begin.
void ChooseCheapest(const PottsProblem& problem, const LabelSets& sets,
                    uint32_t node, uint32_t choice, double weight,
                    std::vector<PricedLabel>* row, uint32_t* labels) {
  row->clear();
  for (uint64_t i = problem.offsets[node]; i < problem.offsets[node + 1]; ++i) {
    if (i == problem.offsets[node] + choice) {
      continue;
    }
    double cost = problem.costs[i];
    if (weight > 0) {
      cost += weight * NumWithout(problem, sets, node, problem.labels[i]);
    }
    row->emplace_back(cost, i);
  }
  const size_t count = sets.offsets[node + 1] - sets.offsets[node];
  if (count == 0) {
    return;
  }
  const auto end = row->begin() + static_cast<ptrdiff_t>(count - 1);
  std::partial_sort(row->begin(), end, row->end());
  *labels++ = problem.Labels(node)[choice];
  for (auto priced = row->begin(); priced != end; ++priced) {
    *labels++ = problem.labels[priced->second];
  }
}

}  // namespace

LabelSets AddFurtherLabels(const PottsProblem& problem,
                           const std::vector<uint32_t>& choices,
                           uint32_t count) {
  constexpr int kRounds = 8;
  const auto num_nodes = static_cast<uint32_t>(problem.NumNodes());
  LabelSets sets;
  for (uint32_t node = 0; node < num_nodes; ++node) {
    sets.offsets.push_back(sets.offsets.back() +
                           std::min(problem.NumLabels(node), count));
  }
  sets.labels.resize(sets.offsets.back());
  std::vector<uint32_t> next(sets.labels.size());
  const int num_rounds = count > 1 ? kRounds : 0;
  for (int round = 0; round <= num_rounds; ++round) {
    // The first round knows nothing of the neighbors.
    const double weight = round > 0 ? problem.weight / 3 : 0;
    tbb::parallel_for(
        tbb::blocked_range<uint32_t>(0, num_nodes),
        [&](const tbb::blocked_range<uint32_t>& range) {
          std::vector<PricedLabel> row;
          for (uint32_t node = range.begin(); node != range.end(); ++node) {
            uint32_t* labels = next.data() + sets.offsets[node];
            if (round == 0 || ChoosesIn(round, node)) {
              ChooseCheapest(problem, sets, node, choices[node], weight, &row,
                             labels);
            } else {
              std::copy(sets.Labels(node), sets.Labels(node + 1), labels);
            }
          }
        });
    sets.labels.swap(next);
  }
  return sets;
}

}  // namespace colmap_ext
