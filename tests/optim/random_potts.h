#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "optim/potts_mrf.h"

namespace colmap_ext {

// Graphs whose nodes have at most three neighbors.
using Edges = std::vector<std::array<uint32_t, 2>>;
using Neighbors = std::vector<std::array<uint32_t, 3>>;

inline Neighbors MakeNeighbors(uint32_t num_nodes, const Edges& edges) {
  Neighbors neighbors(num_nodes, {kNone, kNone, kNone});
  for (const auto& [a, b] : edges) {
    *std::ranges::find(neighbors[a], kNone) = b;
    *std::ranges::find(neighbors[b], kNone) = a;
  }
  return neighbors;
}

// Two rings and what joins them; every node has three neighbors.
inline Edges Prism(uint32_t size) {
  Edges edges;
  for (uint32_t i = 0; i < size; ++i) {
    edges.push_back({i, (i + 1) % size});
    edges.push_back({size + i, size + (i + 1) % size});
    edges.push_back({i, size + i});
  }
  return edges;
}

// A wall of bricks, `size` nodes wide and high.
inline Edges Wall(uint32_t size) {
  Edges edges;
  for (uint32_t i = 0; i < size * size; ++i) {
    if (i % size + 1 < size) {
      edges.push_back({i, i + 1});
    }
    if (i + size < size * size && (i / size + i) % 2 == 0) {
      edges.push_back({i, i + size});
    }
  }
  return edges;
}

// Every node but the first hangs on node (i - 1) / 2.
inline Edges BinaryTree(uint32_t size) {
  Edges edges;
  for (uint32_t i = 1; i < size; ++i) {
    edges.push_back({(i - 1) / 2, i});
  }
  return edges;
}

// The edges when node order[i] is called i.
inline Edges Renumber(const Edges& edges, const std::vector<uint32_t>& order) {
  std::vector<uint32_t> names(order.size());
  for (uint32_t i = 0; i < order.size(); ++i) {
    names[order[i]] = i;
  }
  Edges renumbered;
  for (const auto& [a, b] : edges) {
    renumbered.push_back({names[a], names[b]});
  }
  return renumbered;
}

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

// The first label of each node that has any.
inline std::vector<uint32_t> FirstChoices(const PottsProblem& problem) {
  std::vector<uint32_t> choices(problem.NumNodes(), kNone);
  for (uint32_t node = 0; node < problem.NumNodes(); ++node) {
    choices[node] = problem.NumLabels(node) > 0 ? 0 : kNone;
  }
  return choices;
}

// The least energy of all choices.
inline double BruteForce(const PottsProblem& problem) {
  std::vector<uint32_t> choices = FirstChoices(problem);
  double least = INFINITY;
  while (true) {
    least = std::min(least, PottsEnergy(problem, choices));
    uint32_t node = 0;
    while (node < choices.size() &&
           (choices[node] == kNone ||
            ++choices[node] == problem.NumLabels(node))) {
      choices[node] = choices[node] == kNone ? kNone : 0;
      ++node;
    }
    if (node == choices.size()) {
      return least;
    }
  }
}

}  // namespace colmap_ext
