#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

namespace colmap_ext {

// Graphs whose nodes have at most three neighbors.
using Edges = std::vector<std::array<uint32_t, 2>>;
using Neighbors = std::vector<std::array<uint32_t, 3>>;

inline Neighbors MakeNeighbors(uint32_t num_nodes, const Edges& edges) {
  Neighbors neighbors(num_nodes, {kNone, kNone, kNone});
  for (const auto& [a, b] : edges) {
    *std::find(neighbors[a].begin(), neighbors[a].end(), kNone) = b;
    *std::find(neighbors[b].begin(), neighbors[b].end(), kNone) = a;
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

inline Edges Chain(uint32_t size) {
  Edges edges;
  for (uint32_t i = 0; i + 1 < size; ++i) {
    edges.push_back({i, i + 1});
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

}  // namespace colmap_ext
