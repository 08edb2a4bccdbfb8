#include "optim/potts_mrf.h"

#include <algorithm>

#include "optim/message_passing.h"

namespace colmap_ext {

namespace {

// What a label costs at a node whose neighbors have chosen.
double CostBeside(const PottsProblem& problem,
                  const std::vector<uint32_t>& choices, uint32_t node,
                  uint32_t choice) {
  const uint64_t at = problem.offsets[node] + choice;
  double cost = problem.costs[at];
  for (const uint32_t neighbor : problem.neighbors[node]) {
    if (neighbor != UINT32_MAX && choices[neighbor] != kNoChoice &&
        problem.labels[problem.offsets[neighbor] + choices[neighbor]] !=
            problem.labels[at]) {
      cost += problem.weight;
    }
  }
  return cost;
}

// Iterated conditional modes (Besag 1986).
void Polish(const PottsProblem& problem, std::vector<uint32_t>* choices) {
  constexpr int kMaxRounds = 10;
  for (int round = 0; round < kMaxRounds; ++round) {
    bool has_changed = false;
    for (uint32_t node = 0; node < problem.NumNodes(); ++node) {
      if ((*choices)[node] == kNoChoice) {
        continue;
      }
      double least = CostBeside(problem, *choices, node, (*choices)[node]);
      for (uint32_t choice = 0; choice < problem.NumLabels(node); ++choice) {
        const double cost = CostBeside(problem, *choices, node, choice);
        if (cost < least) {
          least = cost;
          (*choices)[node] = choice;
          has_changed = true;
        }
      }
    }
    if (!has_changed) {
      return;
    }
  }
}

std::vector<uint32_t> CheapestLabels(const PottsProblem& problem) {
  std::vector<uint32_t> choices(problem.NumNodes(), kNoChoice);
  for (uint32_t node = 0; node < problem.NumNodes(); ++node) {
    const float* costs = problem.Costs(node);
    const float* end = costs + problem.NumLabels(node);
    if (costs != end) {
      choices[node] =
          static_cast<uint32_t>(std::min_element(costs, end) - costs);
    }
  }
  return choices;
}

}  // namespace

double PottsEnergy(const PottsProblem& problem,
                   const std::vector<uint32_t>& choices) {
  double energy = 0;
  for (uint32_t node = 0; node < problem.NumNodes(); ++node) {
    if (choices[node] == kNoChoice) {
      continue;
    }
    const uint64_t at = problem.offsets[node] + choices[node];
    energy += problem.costs[at];
    for (const uint32_t neighbor : problem.neighbors[node]) {
      if (neighbor != UINT32_MAX && neighbor > node &&
          choices[neighbor] != kNoChoice &&
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
  constexpr double kMinRise = 1e-4;  // of the bound, from pass to pass
  PottsSolution solution;
  solution.choices = CheapestLabels(problem);
  solution.initial_energy = PottsEnergy(problem, solution.choices);
  solution.energy = solution.initial_energy;
  MessagePassing passing(problem);
  std::vector<uint32_t> choices = solution.choices;
  while (solution.iterations < max_iterations) {
    ++solution.iterations;
    const double energy = passing.Forward(&choices);
    if (energy < solution.energy) {
      solution.energy = energy;
      solution.choices = choices;
    }
    const double bound = passing.Backward();
    const double rise = bound - solution.lower_bound;
    solution.lower_bound = std::max(solution.lower_bound, bound);
    if (solution.energy - solution.lower_bound <= max_gap * solution.energy ||
        (solution.iterations > 1 && rise < kMinRise * solution.lower_bound)) {
      break;
    }
  }
  Polish(problem, &solution.choices);
  solution.energy = PottsEnergy(problem, solution.choices);
  return solution;
}

}  // namespace colmap_ext
