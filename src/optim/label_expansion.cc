#include "optim/potts_mrf.h"

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include <tbb/parallel_for.h>

#include "optim/min_cut.h"

namespace colmap_ext {
namespace {

// Parts of a graph, about as large as each other: each node belongs to the
// nearest of some seeds, by the number of edges between them.
struct Blocks {
  Rows<uint32_t> nodes;          // of each block, ascending
  std::vector<uint32_t> blocks;  // [N] of each node
  std::vector<uint32_t> places;  // [N] of each node, in its block
};

// So small that the cuts' graphs fit a core's cache, and that many cores have
// work. On a sphere of a million facets with 17 labels each, the energy that is
// left above the lower bound is 1.17 % with blocks of 8,192, 1.07 % with
// 16,384, which take a quarter longer.
constexpr uint32_t kBlockSize = 1 << 13;  // nodes, about

// \param first_seed  the others follow, one for each kBlockSize nodes.
Blocks FindBlocks(const std::vector<std::array<uint32_t, 3>>& neighbors,
                  uint32_t first_seed) {
  const auto num_nodes = static_cast<uint32_t>(neighbors.size());
  Blocks blocks;
  blocks.blocks.assign(num_nodes, kNone);
  blocks.places.assign(num_nodes, 0);
  uint32_t num_blocks = 0;
  std::vector<uint32_t> reached;
  reached.reserve(num_nodes);
  const auto reach = [&](uint32_t node, uint32_t block) {
    if (node != kNone && blocks.blocks[node] == kNone) {
      blocks.blocks[node] = block;
      reached.push_back(node);
    }
  };
  for (uint32_t seed = first_seed; seed < num_nodes; seed += kBlockSize) {
    reach(seed, num_blocks++);
  }
  size_t next = 0;
  uint32_t rest = kNone;  // one block of the parts that no seed is in
  for (uint32_t node = 0; node < num_nodes; ++node) {
    if (next == reached.size() && blocks.blocks[node] == kNone) {
      rest = rest == kNone ? num_blocks++ : rest;
      reach(node, rest);
    }
    for (; next < reached.size(); ++next) {
      for (const uint32_t other : neighbors[reached[next]]) {
        reach(other, blocks.blocks[reached[next]]);
      }
    }
  }
  blocks.nodes = NumbersInRows(num_blocks, num_nodes, [&](uint32_t node) {
    return blocks.blocks[node];
  });
  tbb::parallel_for(size_t{0}, blocks.nodes.size(), [&](size_t block) {
    uint32_t place = 0;
    for (const uint32_t node : blocks.nodes[block]) {
      blocks.places[node] = place++;
    }
  });
  return blocks;
}

// [labels] some nodes that have each label, in their order.
Rows<uint32_t> FindNodes(const PottsProblem& problem,
                         std::span<const uint32_t> nodes) {
  uint32_t num_labels = 0;
  for (const uint32_t node : nodes) {
    if (problem.NumLabels(node) > 0) {  // ascending
      num_labels = std::max(num_labels, problem.Labels(node).back() + 1);
    }
  }
  return GroupInRows<uint32_t>(num_labels, [&](const auto& add) {
    for (const uint32_t node : nodes) {
      for (const uint32_t label : problem.Labels(node)) {
        add(label, node);
      }
    }
  });
}

// What a cost of 1 is as a capacity. A node pays for a label and for three
// edges at most.
double CapacityScale(const PottsProblem& problem) {
  const double most =
      (problem.costs.empty() ? 0 : std::ranges::max(problem.costs)) +
      3 * problem.weight;
  return most > 0 ? kMaxCapacity / most : 0;
}

// The round for a block's nodes, while the others keep their labels.
class BlockExpansion {
 public:
  // \param choices [N] those of the block change, those of its neighbors are
  //        read
  BlockExpansion(const PottsProblem& problem, double scale,
                 const Blocks& blocks, uint32_t block,
                 std::vector<uint32_t>* choices)
      : problem_(problem),
        scale_(scale),
        blocks_(blocks),
        block_(block),
        choices_(*choices),
        nodes_of_labels_(FindNodes(problem, blocks.nodes[block])),
        places_(blocks.nodes[block].size(), kNone) {}

  void Run() {
    for (uint32_t label = 0; label < nodes_of_labels_.size(); ++label) {
      Expand(label);
    }
  }

 private:
  // Nodes on the source's side take the label.
  void Expand(uint32_t label) {
    FindMovable(label);
    const size_t num_nodes = movable_.size();
    neighbors_.assign(num_nodes, {kNone, kNone, kNone, kNone});
    capacities_.assign(num_nodes, {});
    for (size_t i = 0; i < num_nodes; ++i) {
      AddNode(i, label);
    }
    const MinCut cut = ComputeMinCut(neighbors_, capacities_);
    for (size_t i = 0; i < num_nodes; ++i) {
      places_[blocks_.places[movable_[i]]] = kNone;
      if (cut.on_source_side[i] != 0) {
        choices_[movable_[i]] = Place(movable_[i], label);
      }
    }
  }

  // The nodes that have the label and have not chosen it.
  void FindMovable(uint32_t label) {
    movable_.clear();
    for (const uint32_t node : nodes_of_labels_[label]) {
      if (Chosen(node) != label) {
        places_[blocks_.places[node]] = static_cast<uint32_t>(movable_.size());
        movable_.push_back(node);
      }
    }
  }

  // An edge between two that can move costs the weight if one alone takes the
  // label. Where they differ now, it does too if none takes it: the second pays
  // if it keeps its own, and the edge if the first alone does.
  void AddNode(size_t place, uint32_t label) {
    const uint32_t node = movable_[place];
    double keep = problem_.Costs(node)[choices_[node]];
    double take = problem_.Costs(node)[Place(node, label)];
    for (int k = 0; k < 3; ++k) {
      const uint32_t other = problem_.neighbors[node][k];
      if (other == kNone || choices_[other] == kNone) {
        continue;
      }
      const bool differs = Chosen(other) != Chosen(node);
      const uint32_t other_place = PlaceInGraph(other);
      if (other_place == kNone) {
        keep += differs ? problem_.weight : 0;
        take += Chosen(other) != label ? problem_.weight : 0;
        continue;
      }
      const bool is_second = node > other;
      keep += differs && is_second ? problem_.weight : 0;
      neighbors_[place][k] = other_place;
      capacities_[place].arcs[k] =
          differs && !is_second ? 0 : Capacity(problem_.weight);
    }
    capacities_[place].source = Capacity(keep);
    capacities_[place].sink = Capacity(take);
  }

  uint32_t Chosen(uint32_t node) const {
    return problem_.Labels(node)[choices_[node]];
  }

  // In movable_, or kNone.
  uint32_t PlaceInGraph(uint32_t node) const {
    return blocks_.blocks[node] == block_ ? places_[blocks_.places[node]]
                                          : kNone;
  }

  uint32_t Place(uint32_t node, uint32_t label) const {
    return IndexOf(problem_.Labels(node), label);
  }

  uint32_t Capacity(double cost) const {
    return static_cast<uint32_t>(cost * scale_ + 0.5);
  }

  const PottsProblem& problem_;
  const double scale_;
  const Blocks& blocks_;
  const uint32_t block_;
  std::vector<uint32_t>& choices_;
  const Rows<uint32_t> nodes_of_labels_;
  std::vector<uint32_t> movable_;  // nodes
  std::vector<uint32_t> places_;   // [nodes of the block], see PlaceInGraph
  // The cut's graph, of movable_.
  std::vector<std::array<uint32_t, 4>> neighbors_;
  FlowCapacities capacities_;
};

// Blocks of the same color have no edges between them: each has the least color
// that no block before it and next to it has.
Rows<uint32_t> ColorBlocks(const PottsProblem& problem, const Blocks& blocks) {
  std::vector<uint32_t> colors;  // [blocks]
  uint32_t num_colors = 0;
  for (uint32_t block = 0; block < blocks.nodes.size(); ++block) {
    std::vector<uint8_t> is_taken(num_colors + 1, 0);
    for (const uint32_t node : blocks.nodes[block]) {
      for (const uint32_t other : problem.neighbors[node]) {
        if (other != kNone && blocks.blocks[other] < block) {
          is_taken[colors[blocks.blocks[other]]] = 1;
        }
      }
    }
    colors.push_back(static_cast<uint32_t>(std::ranges::find(is_taken, 0) -
                                           is_taken.begin()));
    num_colors = std::max(num_colors, colors.back() + 1);
  }
  return NumbersInRows(num_colors, colors.size(),
                       [&](uint32_t block) { return colors[block]; });
}

}  // namespace

std::vector<uint32_t> ExpandLabels(const PottsProblem& problem,
                                   std::vector<uint32_t> choices) {
  const double scale = CapacityScale(problem);
  const bool is_one_block = problem.NumNodes() <= kBlockSize;
  for (const uint32_t first_seed : {uint32_t{0}, kBlockSize / 2}) {
    const Blocks blocks = FindBlocks(problem.neighbors, first_seed);
    const Rows<uint32_t> colors = ColorBlocks(problem, blocks);
    for (size_t color = 0; color < colors.size(); ++color) {
      tbb::parallel_for(size_t{0}, colors[color].size(), [&](size_t i) {
        BlockExpansion(problem, scale, blocks, colors[color][i], &choices)
            .Run();
      });
    }
    if (is_one_block) {
      break;
    }
  }
  return choices;
}

}  // namespace colmap_ext
