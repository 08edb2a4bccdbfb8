#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/rows.h"

namespace colmap_ext {

// A Markov random field whose nodes choose one label each, every node among a
// few of its own: the sum of the chosen labels' costs, and `weight` for each
// two neighbors with different labels.
struct PottsProblem {
  std::vector<uint64_t> offsets{0};  // [N + 1], into labels and costs
  std::vector<uint32_t> labels;      // ascending in each node's row
  std::vector<float> costs;          // of each label at its node, >= 0
  // [N] at most three, as facets have; kNone: none. Symmetric, no repeats.
  std::vector<std::array<uint32_t, 3>> neighbors;
  double weight = 0;  // >= 0

  size_t NumNodes() const { return neighbors.size(); }

  uint32_t NumLabels(uint32_t node) const {
    return static_cast<uint32_t>(offsets[node + 1] - offsets[node]);
  }

  std::span<const uint32_t> Labels(uint32_t node) const {
    return {labels.data() + offsets[node], NumLabels(node)};
  }

  std::span<const float> Costs(uint32_t node) const {
    return {costs.data() + offsets[node], NumLabels(node)};
  }
};

struct PottsSolution {
  // [N] which of a node's labels, its place in the row; kNone where there
  // are none: such nodes and their edges are no part of the energy.
  std::vector<uint32_t> choices;
  double initial_energy = 0;  // of the cheapest label everywhere
  double energy = 0;          // never above the initial one
  double lower_bound = 0;     // of all labelings' energies
  int iterations = 0;
};

// Sequential tree-reweighted message passing [Kolmogorov2006] until the energy
// is within `max_gap` of the lower bound, relative to the energy, the bound no
// longer rises, or `max_iterations` are done. Messages are passed in the nodes'
// order: nodes in a SweepOrder let them run far, in parallel, and close in
// memory. Time of an iteration and memory follow the sum of the nodes' labels.
PottsSolution SolvePotts(const PottsProblem& problem, double max_gap = 1e-3,
                         int max_iterations = 20);

// The energy of any choices.
// \param choices [N] see PottsSolution
double PottsEnergy(const PottsProblem& problem,
                   const std::vector<uint32_t>& choices);

// An order to visit a graph's nodes in, each after what its neighbors before it
// have left: by their distance from the nearest of some seeds, one for each
// 2,048 nodes, so that paths of growing order run far through the graph. Nodes
// of the same distance are sorted so that long runs of the order have no
// neighbors among them, and can be visited at the same time; parts that are not
// connected run side by side.
//
// \param neighbors  [N] symmetric; kNone: none.
// \return  [N] nodes.
std::vector<uint32_t> SweepOrder(
    const std::vector<std::array<uint32_t, 3>>& neighbors);

// Several labels of each node, or none. [N]
using LabelSets = Rows<uint32_t>;

// The chosen label of each node, none where it has no choice.
// \param choices  [N] see PottsSolution
LabelSets ChosenLabels(const PottsProblem& problem,
                       const std::vector<uint32_t>& choices);

// Adds to each node's labels the cheapest others, `count` in all where it has
// as many. As with the first label, those that neighbors have too are
// preferred: for each neighbor that has not got it, a label costs a third of
// the field's weight more: a label that no neighbor has costs the weight. That
// is approached in a few rounds, in each of which half of the nodes choose
// again by what their neighbors have.
//
// \param given  labels that stay, and stay first; not more than `count` a node
// \return the labels of each node, `count` or all that it has
LabelSets AddFurtherLabels(const PottsProblem& problem, const LabelSets& given,
                           uint32_t count);

}  // namespace colmap_ext
