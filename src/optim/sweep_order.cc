#include "optim/potts_mrf.h"

#include <algorithm>

namespace colmap_ext {
namespace {

using Neighbors = std::vector<std::array<uint32_t, 3>>;

struct Search {
  std::vector<uint32_t> order;   // [N] nodes, one connected part after another
  std::vector<uint32_t> levels;  // [N] edges from the part's first node
};

Search BreadthFirst(const Neighbors& neighbors) {
  Search search;
  search.order.reserve(neighbors.size());
  search.levels.assign(neighbors.size(), kNone);
  const auto reach = [&](uint32_t node, uint32_t level) {
    if (node != kNone && search.levels[node] == kNone) {
      search.levels[node] = level;
      search.order.push_back(node);
    }
  };
  size_t next = 0;
  for (uint32_t seed = 0; seed < neighbors.size(); ++seed) {
    reach(seed, 0);
    for (; next < search.order.size(); ++next) {
      const uint32_t node = search.order[next];
      for (const uint32_t other : neighbors[node]) {
        reach(other, search.levels[node] + 1);
      }
    }
  }
  return search;
}

// Nodes of the same class are not neighbors: 4 * level + color, the least that
// no neighbor in the same level has got before; three neighbors take three.
std::vector<uint32_t> Classes(const Neighbors& neighbors,
                              const Search& search) {
  std::vector<uint32_t> classes(neighbors.size(), kNone);
  for (const uint32_t node : search.order) {
    uint32_t color = 4 * search.levels[node];
    const auto& row = neighbors[node];
    const auto is_taken = [&](uint32_t other) {
      return other != kNone && classes[other] == color;
    };
    while (std::ranges::any_of(row, is_taken)) {
      ++color;
    }
    classes[node] = color;
  }
  return classes;
}

}  // namespace

std::vector<uint32_t> SweepOrder(const Neighbors& neighbors) {
  const Search search = BreadthFirst(neighbors);
  const std::vector<uint32_t> classes = Classes(neighbors, search);
  const uint32_t num_classes =
      classes.empty() ? 0 : *std::ranges::max_element(classes) + 1;
  // Nodes of a class stay in the search's order.
  return GroupInRows<uint32_t>(num_classes,
                               [&](const auto& add) {
                                 for (const uint32_t node : search.order) {
                                   add(classes[node], node);
                                 }
                               })
      .values;
}

}  // namespace colmap_ext
