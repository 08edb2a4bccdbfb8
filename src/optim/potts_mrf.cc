#include "optim/potts_mrf.h"

#include <algorithm>
#include <utility>

#include "optim/label_expansion.h"
#include "optim/message_passing.h"

namespace colmap_ext {

namespace {

std::vector<uint32_t> CheapestLabels(const PottsProblem& problem) {
  std::vector<uint32_t> choices(problem.NumNodes(), kNone);
  for (uint32_t node = 0; node < problem.NumNodes(); ++node) {
    const auto costs = problem.Costs(node);
    if (!costs.empty()) {
      choices[node] = static_cast<uint32_t>(std::ranges::min_element(costs) -
                                            costs.begin());
    }
  }
  return choices;
}

}  // namespace

double PottsEnergy(const PottsProblem& problem,
                   const std::vector<uint32_t>& choices) {
  double energy = 0;
  for (uint32_t node = 0; node < problem.NumNodes(); ++node) {
    if (choices[node] == kNone) {
      continue;
    }
    const uint64_t at = problem.offsets[node] + choices[node];
    energy += problem.costs[at];
    for (const uint32_t neighbor : problem.neighbors[node]) {
      if (neighbor != kNone && neighbor > node && choices[neighbor] != kNone &&
          problem.labels[problem.offsets[neighbor] + choices[neighbor]] !=
              problem.labels[at]) {
        energy += problem.weight;
      }
    }
  }
  return energy;
}

PottsSolution SolvePotts(const PottsProblem& problem, double max_gap,
                         int max_iterations) {
  PottsSolution solution;
  solution.choices = CheapestLabels(problem);
  solution.initial_energy = PottsEnergy(problem, solution.choices);
  solution.energy = solution.initial_energy;
  PassMessages(problem, max_gap, max_iterations, &solution);
  solution.energy = PottsEnergy(problem, solution.choices);
  std::vector<uint32_t> expanded = ExpandLabels(problem, solution.choices);
  const double energy = PottsEnergy(problem, expanded);
  OfferChoices(std::move(expanded), energy, &solution);
  return solution;
}

}  // namespace colmap_ext
