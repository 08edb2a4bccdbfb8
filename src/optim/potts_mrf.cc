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

// Takes the choices if they are better.
void Offer(std::vector<uint32_t> choices, double energy,
           PottsSolution* solution) {
  if (energy < solution->energy) {
    solution->energy = energy;
    solution->choices = std::move(choices);
  }
}

void PassMessages(const PottsProblem& problem, double max_gap,
                  int max_iterations, PottsSolution* solution) {
  // Relative to the bound, from pass to pass. A third of the default max_gap:
  // at a slower rise the gap would take many passes to close, which the alpha
  // expansion does in one round.
  constexpr double kMinRise = 3e-4;
  MessagePassing passing(problem);
  std::vector<uint32_t> choices = solution->choices;
  while (solution->iterations < max_iterations) {
    ++solution->iterations;
    const double energy = passing.Forward(&choices);
    Offer(choices, energy, solution);
    const double bound = passing.Backward();
    const double rise = bound - solution->lower_bound;
    solution->lower_bound = std::max(solution->lower_bound, bound);
    if (solution->energy - solution->lower_bound <=
            max_gap * solution->energy ||
        (solution->iterations > 1 && rise < kMinRise * solution->lower_bound)) {
      return;
    }
  }
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
  Offer(std::move(expanded), energy, &solution);
  return solution;
}

}  // namespace colmap_ext
