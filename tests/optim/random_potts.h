#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "optim/potts_mrf.h"
#include "tests/optim/graphs.h"

namespace colmap_ext {

// Every node gets each of `num_labels` labels with the given probability.
inline PottsProblem RandomProblem(uint32_t num_nodes, const Edges& edges,
                                  uint32_t num_labels, double probability,
                                  double weight, uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> uniform;
  PottsProblem problem;
  problem.weight = weight;
  problem.neighbors = MakeNeighbors(num_nodes, edges);
  for (uint32_t node = 0; node < num_nodes; ++node) {
    for (uint32_t label = 0; label < num_labels; ++label) {
      if (uniform(random) < probability) {
        problem.labels.push_back(label);
        problem.costs.push_back(3 * uniform(random));
      }
    }
    problem.offsets.push_back(problem.labels.size());
  }
  return problem;
}

// The least energy of all choices.
inline double BruteForce(const PottsProblem& problem) {
  std::vector<uint32_t> choices(problem.NumNodes(), 0);
  const auto count = [&](size_t node) {
    return static_cast<uint32_t>(problem.offsets[node + 1] -
                                 problem.offsets[node]);
  };
  for (size_t i = 0; i < choices.size(); ++i) {
    choices[i] = count(i) == 0 ? kNone : 0;
  }
  double least = INFINITY;
  while (true) {
    least = std::min(least, PottsEnergy(problem, choices));
    size_t node = 0;
    while (node < choices.size() &&
           (choices[node] == kNone || ++choices[node] == count(node))) {
      choices[node] = choices[node] == kNone ? kNone : 0;
      ++node;
    }
    if (node == choices.size()) {
      return least;
    }
  }
}

}  // namespace colmap_ext
