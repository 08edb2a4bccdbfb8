#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/index_limit.h"

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
// longer rises, or `max_iterations` are done; then alpha
// expansion (ExpandLabels), as messages alone take very long to decide
// which label is best for a large area. Messages are passed in the nodes'
// order: nodes in a SweepOrder let them run far, in parallel, and close in
// memory. Time of an iteration and memory follow the sum of the nodes' labels.
PottsSolution SolvePotts(const PottsProblem& problem, double max_gap = 1e-3,
                         int max_iterations = 20);

// The energy of any choices.
// \param choices [N] see PottsSolution
double PottsEnergy(const PottsProblem& problem,
                   const std::vector<uint32_t>& choices);

}  // namespace colmap_ext
