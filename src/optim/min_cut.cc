#include "optim/min_cut.h"

#include <algorithm>
#include <cassert>
#include <limits>

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

namespace colmap_ext {
namespace {

constexpr uint32_t kNone = UINT32_MAX;

// Where a node hangs in its tree: the arc to its parent, or one of these.
constexpr uint8_t kTerminal = 4;  // the source or the sink itself
constexpr uint8_t kOrphan = 5;
constexpr uint8_t kFree = 6;  // in no tree

// A distance as a node holds it. Those beyond count as one: distances choose
// between parents, nothing depends on them.
uint16_t Near(uint32_t distance) {
  return static_cast<uint16_t>(std::min<uint32_t>(distance, UINT16_MAX));
}

int32_t Clamp(uint32_t capacity) {
  return static_cast<int32_t>(std::min(capacity, kMaxCapacity));
}

struct alignas(32) Node {
  std::array<int32_t, 4> residual;  // of the arcs to the neighbors
  int32_t terminal;                 // > 0: from the source, < 0: to the sink
  uint32_t next_active;             // itself: last in the queue; kNone: not in
  uint32_t stamp;
  uint16_t distance;  // to the terminal, at the time `stamp`; Near()
  uint8_t mirrors;    // which arc of each neighbor leads back, two bits each
  uint8_t parent : 7;
  bool in_sink_tree : 1;

  uint8_t Mirror(int arc) const { return mirrors >> (2 * arc) & 3; }
};

// The cut's nodes and arcs, and what flows.
struct Network {
  NeighborView neighbors;
  std::vector<Node> nodes;
};

// Augments paths within a region: consecutive nodes and the arcs between them.
// What it leaves, flow and trees, is where a larger region around it goes on.
class RegionSolver {
 public:
  // \param start_time  later than all times at which the nodes got distances
  RegionSolver(Network* network, uint32_t begin, uint32_t end,
               uint32_t start_time)
      : neighbors_(network->neighbors),
        nodes_(network->nodes.data()),
        begin_(begin),
        size_(end - begin),
        time_(start_time) {}

  // In a region where nothing flows yet, all that the terminals reach.
  void ActivateTerminals() {
    for (uint32_t i = begin_; i < begin_ + size_; ++i) {
      if (nodes_[i].terminal != 0) {
        Activate(i);
      }
    }
  }

  // In a region of two that are solved, the nodes in trees with arcs from one
  // to the other.
  // \param middle  the first node of the second one
  void ActivateAcross(uint32_t middle) {
    for (uint32_t i = begin_; i < begin_ + size_; ++i) {
      if (nodes_[i].parent != kFree &&
          std::ranges::any_of(neighbors_[i], [&](uint32_t other) {
            return IsInside(other) && (other < middle) != (i < middle);
          })) {
        Activate(i);
      }
    }
  }

  void Run() {
    while (first_active_ != kNone) {
      const uint32_t node = first_active_;
      if (nodes_[node].parent == kFree || !Grow(node)) {
        PopActive();
      }
    }
  }

  int64_t flow() const { return flow_; }
  uint32_t time() const { return time_; }

 private:
  bool IsInside(uint32_t node) const { return node - begin_ < size_; }

  void Activate(uint32_t index) {
    if (nodes_[index].next_active != kNone) {
      return;
    }
    nodes_[index].next_active = index;
    if (last_active_ == kNone) {
      first_active_ = index;
    } else {
      nodes_[last_active_].next_active = index;
    }
    last_active_ = index;
  }

  void PopActive() {
    Node& node = nodes_[first_active_];
    const bool is_last = node.next_active == first_active_;
    const uint32_t next = is_last ? kNone : node.next_active;
    node.next_active = kNone;
    first_active_ = next;
    if (is_last) {
      last_active_ = kNone;
    }
  }

  // The residual capacity between a node and its neighbor k in the direction in
  // which flow passes in the node's tree from the node to the neighbor's side:
  // away from the source, or from the neighbor towards the sink.
  int32_t Outward(const Node& node, int k, const Node& neighbor) const {
    return node.in_sink_tree ? neighbor.residual[node.Mirror(k)]
                             : node.residual[k];
  }

  int32_t Inward(const Node& node, int k, const Node& neighbor) const {
    return node.in_sink_tree ? node.residual[k]
                             : neighbor.residual[node.Mirror(k)];
  }

  // Lets the tree grow from an active node. Where it meets the other tree, flow
  // is augmented and the trees are repaired.
  // \return whether it met the other tree; the node stays active then.
  bool Grow(uint32_t index) {
    Node& node = nodes_[index];
    for (int k = 0; k < 4; ++k) {
      const uint32_t other = neighbors_[index][k];
      if (!IsInside(other)) {
        continue;
      }
      Node& neighbor = nodes_[other];
      if (Outward(node, k, neighbor) == 0) {
        continue;
      }
      if (neighbor.parent == kFree) {
        neighbor.in_sink_tree = node.in_sink_tree;
        Adopt(&neighbor, node, k);
        Activate(other);
      } else if (neighbor.in_sink_tree != node.in_sink_tree) {
        if (node.in_sink_tree) {
          Augment(other, node.Mirror(k));
        } else {
          Augment(index, k);
        }
        return true;
      } else if (neighbor.stamp <= node.stamp &&
                 neighbor.distance > node.distance + 1) {
        Adopt(&neighbor, node, k);  // a shorter way to the terminal
      }
    }
    return false;
  }

  static void Adopt(Node* child, const Node& parent, int arc_of_parent) {
    child->parent = parent.Mirror(arc_of_parent);
    child->distance = Near(parent.distance + 1u);
    child->stamp = parent.stamp;
  }

  // Pushes as much as fits from the source to the sink over the arc from a node
  // of the source's tree to one of the sink's.
  void Augment(uint32_t from, int arc) {
    const uint32_t to = neighbors_[from][arc];
    int32_t amount = nodes_[from].residual[arc];
    amount = std::min(amount, Bottleneck(from));
    amount = std::min(amount, Bottleneck(to));
    nodes_[from].residual[arc] -= amount;
    nodes_[to].residual[nodes_[from].Mirror(arc)] += amount;
    Push(from, amount);
    Push(to, amount);
    flow_ += amount;
    ++time_;
    for (size_t i = 0; i < orphans_.size(); ++i) {
      FindParent(orphans_[i]);
    }
    orphans_.clear();
  }

  int32_t Bottleneck(uint32_t index) const {
    int32_t amount = std::numeric_limits<int32_t>::max();
    for (;;) {
      const Node& node = nodes_[index];
      if (node.parent == kTerminal) {
        return std::min(amount, std::abs(node.terminal));
      }
      const uint32_t parent = neighbors_[index][node.parent];
      amount = std::min(amount, Inward(node, node.parent, nodes_[parent]));
      index = parent;
    }
  }

  // Pushes along the path between a node and its tree's terminal. Nodes whose
  // arc to the parent is then full become orphans.
  void Push(uint32_t index, int32_t amount) {
    for (;;) {
      Node& node = nodes_[index];
      const uint8_t arc = node.parent;
      if (arc == kTerminal) {
        node.terminal += node.in_sink_tree ? amount : -amount;
        if (node.terminal == 0) {
          MakeOrphan(index);
        }
        return;
      }
      const uint32_t parent = neighbors_[index][arc];
      int32_t& towards_parent = node.residual[arc];
      int32_t& from_parent = nodes_[parent].residual[node.Mirror(arc)];
      towards_parent += node.in_sink_tree ? -amount : amount;
      from_parent += node.in_sink_tree ? amount : -amount;
      if ((node.in_sink_tree ? towards_parent : from_parent) == 0) {
        MakeOrphan(index);
      }
      index = parent;
    }
  }

  void MakeOrphan(uint32_t index) {
    nodes_[index].parent = kOrphan;
    orphans_.push_back(index);
  }

  // Hangs an orphan to the neighbor that is nearest to the terminal; without
  // one it leaves the tree, and its children are orphans.
  void FindParent(uint32_t index) {
    Node& node = nodes_[index];
    uint32_t nearest = kNone;
    for (int k = 0; k < 4; ++k) {
      const uint32_t other = neighbors_[index][k];
      if (!IsInside(other) || nodes_[other].parent == kFree ||
          nodes_[other].in_sink_tree != node.in_sink_tree ||
          Inward(node, k, nodes_[other]) == 0) {
        continue;
      }
      const uint32_t distance = DistanceToTerminal(other);
      if (distance < nearest) {
        nearest = distance;
        node.parent = static_cast<uint8_t>(k);
      }
    }
    if (nearest != kNone) {
      node.distance = Near(nearest + 1);
      node.stamp = time_;
      return;
    }
    node.parent = kFree;
    for (int k = 0; k < 4; ++k) {
      const uint32_t other = neighbors_[index][k];
      if (!IsInside(other) || nodes_[other].parent == kFree ||
          nodes_[other].in_sink_tree != node.in_sink_tree) {
        continue;
      }
      if (Inward(node, k, nodes_[other]) > 0) {
        Activate(other);
      }
      if (nodes_[other].parent == node.Mirror(k)) {
        MakeOrphan(other);
      }
    }
  }

  // The length of the way to the terminal, or kNone where it ends in an orphan.
  // What is found is noted along the way, for the next one who asks.
  uint32_t DistanceToTerminal(uint32_t index) {
    uint32_t distance = 0;
    uint32_t at = index;
    for (;;) {
      const Node& node = nodes_[at];
      if (node.stamp == time_) {
        distance += node.distance;
        break;
      }
      if (node.parent == kTerminal) {
        ++distance;
        nodes_[at].stamp = time_;
        nodes_[at].distance = 1;
        break;
      }
      if (node.parent == kOrphan) {
        return kNone;
      }
      ++distance;
      at = neighbors_[at][node.parent];
    }
    uint32_t remaining = distance;
    for (at = index; nodes_[at].stamp != time_;
         at = neighbors_[at][nodes_[at].parent]) {
      nodes_[at].stamp = time_;
      nodes_[at].distance = Near(remaining--);
    }
    return distance;
  }

  const NeighborView neighbors_;
  Node* const nodes_;
  const uint32_t begin_;
  const uint32_t size_;
  std::vector<uint32_t> orphans_;
  uint32_t first_active_ = kNone;
  uint32_t last_active_ = kNone;
  uint32_t time_;
  int64_t flow_ = 0;
};

// Nothing flows; nodes with a terminal are in its tree.
void InitializeNode(const FlowCapacities& graph, uint32_t index,
                    Network* network) {
  const auto& row = network->neighbors[index];
  Node& node = network->nodes[index];
  node.mirrors = 0;
  for (int k = 0; k < 4; ++k) {
    node.residual[k] = Clamp(graph.capacities[index][k]);
    if (row[k] != kNoNeighbor) {
      const auto& others = network->neighbors[row[k]];
      const auto back = std::ranges::find(others, index);
      assert(back != others.end());
      node.mirrors |= static_cast<uint8_t>((back - others.begin()) << (2 * k));
    }
  }
  node.terminal = Clamp(graph.source[index]) - Clamp(graph.sink[index]);
  node.in_sink_tree = node.terminal < 0;
  node.parent = node.terminal != 0 ? kTerminal : kFree;
  node.distance = 1;
  node.stamp = 0;
  node.next_active = kNone;
}

// A region that is solved.
struct Solved {
  int64_t flow = 0;
  uint32_t time = 0;
};

// Solves both halves of a region side by side and then goes on where they meet
// [Liu2010].
Solved Solve(uint32_t begin, uint32_t end, Network* network) {
  // So large that few paths lead from region to region.
  constexpr uint32_t kMinRegion = 1 << 16;
  if (end - begin < 2 * kMinRegion) {
    RegionSolver solver(network, begin, end, 0);
    solver.ActivateTerminals();
    solver.Run();
    return {solver.flow(), solver.time()};
  }
  const uint32_t middle = begin + (end - begin) / 2;
  Solved first;
  Solved second;
  tbb::parallel_invoke([&] { first = Solve(begin, middle, network); },
                       [&] { second = Solve(middle, end, network); });
  RegionSolver solver(network, begin, end,
                      std::max(first.time, second.time) + 1);
  solver.ActivateAcross(middle);
  solver.Run();
  return {first.flow + second.flow + solver.flow(), solver.time()};
}

}  // namespace

MinCut ComputeMinCut(NeighborView neighbors, const FlowCapacities& capacities) {
  const auto num_nodes = static_cast<uint32_t>(capacities.size());
  Network network{neighbors, std::vector<Node>(num_nodes)};
  tbb::parallel_for(uint32_t{0}, num_nodes, [&](uint32_t i) {
    InitializeNode(capacities, i, &network);
  });
  MinCut cut;
  cut.flow = Solve(0, num_nodes, &network).flow;
  for (uint32_t i = 0; i < num_nodes; ++i) {
    // What goes straight through the node.
    cut.flow +=
        std::min(Clamp(capacities.source[i]), Clamp(capacities.sink[i]));
  }
  cut.on_source_side.resize(num_nodes);
  std::ranges::transform(network.nodes, cut.on_source_side.begin(),
                         [](const Node& node) {
                           return node.parent != kFree && !node.in_sink_tree;
                         });
  return cut;
}

MinCut ComputeMinCut(const FlowGraph& graph) {
  return ComputeMinCut(NeighborView(graph), graph);
}

int64_t CutValue(NeighborView neighbors, const FlowCapacities& graph,
                 const std::vector<uint8_t>& on_source_side) {
  int64_t value = 0;
  for (size_t i = 0; i < graph.size(); ++i) {
    if (!on_source_side[i]) {
      value += Clamp(graph.source[i]);
      continue;
    }
    value += Clamp(graph.sink[i]);
    for (int k = 0; k < 4; ++k) {
      const uint32_t other = neighbors[i][k];
      if (other != kNoNeighbor && !on_source_side[other]) {
        value += Clamp(graph.capacities[i][k]);
      }
    }
  }
  return value;
}

int64_t CutValue(const FlowGraph& graph,
                 const std::vector<uint8_t>& on_source_side) {
  return CutValue(NeighborView(graph), graph, on_source_side);
}

}  // namespace colmap_ext
