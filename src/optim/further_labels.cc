#include "optim/potts_mrf.h"

#include <algorithm>
#include <cstddef>
#include <span>
#include <utility>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace colmap_ext {
namespace {

using PricedLabel = std::pair<double, uint32_t>;

// How many of a node's neighbors have not got a label.
int NumWithout(const PottsProblem& problem, const LabelSets& sets,
               uint32_t node, uint32_t label) {
  return static_cast<int>(
      std::ranges::count_if(problem.neighbors[node], [&](uint32_t neighbor) {
        return neighbor != kNone &&
               std::ranges::count(sets[neighbor], label) == 0;
      }));
}

// Whether the node chooses in a round: a half of the nodes does, another one in
// each round. If all chose at once, neighbors would take each other's labels in
// turn for ever.
bool ChoosesIn(int round, uint32_t node) {
  // A leading bit of the node times 2^32 over the golden ratio (multiplicative
  // hashing [Knuth1998, section 6.4]).
  return ((node * 0x9e3779b1U) >> (31 - round) & 1) != 0;
}

// Writes the given labels of a node and the cheapest others to `chosen`.
void ChooseCheapest(const PottsProblem& problem, const LabelSets& given,
                    const LabelSets& sets, uint32_t node, double weight,
                    std::vector<PricedLabel>* row, std::span<uint32_t> chosen) {
  const auto given_labels = given[node];
  row->clear();
  for (uint64_t i = problem.offsets[node]; i < problem.offsets[node + 1]; ++i) {
    const uint32_t label = problem.labels[i];
    if (std::ranges::find(given_labels, label) != given_labels.end()) {
      continue;
    }
    const int num_without =
        weight > 0 ? NumWithout(problem, sets, node, label) : 0;
    row->emplace_back(problem.costs[i] + weight * num_without, label);
  }
  std::ranges::copy(given_labels, chosen.begin());
  const auto others = chosen.subspan(given_labels.size());
  std::partial_sort(row->begin(),
                    row->begin() + static_cast<ptrdiff_t>(others.size()),
                    row->end());
  for (size_t i = 0; i < others.size(); ++i) {
    others[i] = (*row)[i].second;
  }
}

// The labels that some nodes have after a round: those of nodes that do not
// choose in it stay.
void ChooseInRound(const PottsProblem& problem, const LabelSets& given,
                   const LabelSets& sets, int round,
                   const tbb::blocked_range<uint32_t>& nodes,
                   std::vector<uint32_t>* next) {
  const double weight = round > 0 ? problem.weight / 3 : 0;
  std::vector<PricedLabel> row;
  for (uint32_t node = nodes.begin(); node != nodes.end(); ++node) {
    const std::span<uint32_t> chosen(next->data() + sets.offsets[node],
                                     sets[node].size());
    if (round == 0 || ChoosesIn(round, node)) {
      ChooseCheapest(problem, given, sets, node, weight, &row, chosen);
    } else {
      std::ranges::copy(sets[node], chosen.begin());
    }
  }
}

}  // namespace

LabelSets ChosenLabels(const PottsProblem& problem,
                       const std::vector<uint32_t>& choices) {
  LabelSets sets;
  for (uint32_t node = 0; node < choices.size(); ++node) {
    if (choices[node] != kNone) {
      sets.values.push_back(problem.Labels(node)[choices[node]]);
    }
    sets.EndRow();
  }
  return sets;
}

LabelSets AddFurtherLabels(const PottsProblem& problem, const LabelSets& given,
                           uint32_t count) {
  // The first round ignores the neighbors; each node chooses again in half of
  // the other rounds.
  constexpr int kRounds = 9;
  const auto num_nodes = static_cast<uint32_t>(problem.NumNodes());
  LabelSets sets;
  for (uint32_t node = 0; node < num_nodes; ++node) {
    sets.offsets.push_back(sets.offsets.back() +
                           std::min(problem.NumLabels(node), count));
  }
  if (sets.offsets.back() == given.values.size()) {
    return given;
  }
  sets.values.resize(sets.offsets.back());
  std::vector<uint32_t> next(sets.values.size());
  for (int round = 0; round < kRounds; ++round) {
    tbb::parallel_for(tbb::blocked_range<uint32_t>(0, num_nodes),
                      [&](const tbb::blocked_range<uint32_t>& nodes) {
                        ChooseInRound(problem, given, sets, round, nodes,
                                      &next);
                      });
    sets.values.swap(next);
  }
  return sets;
}

}  // namespace colmap_ext
