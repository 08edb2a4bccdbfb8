#include "optim/min_cut.h"

#include <algorithm>
#include <cassert>
#include <cstdlib>
#include <limits>
#include <utility>

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include "base/indices.h"

namespace colmap_ext {
namespace {

// The parent of a node in its tree: the arc to it, or one of these.
constexpr uint8_t kTerminalParent = 4;  // the source or the sink itself
constexpr uint8_t kOrphanParent = 5;
constexpr uint8_t kNoParent = 6;  // in no tree

struct alignas(32) FlowNode {
  std::array<int32_t, 4> residual;  // of the arcs to the neighbors
  int32_t terminal;                 // > 0: from the source, < 0: to the sink
  uint32_t next_active;             // itself: last in the queue; kNone: not in
  uint32_t stamp;                   // the time of the distance
  uint16_t distance;                // to the terminal; UINT16_MAX: or more
  uint8_t mirrors;  // which arc of each neighbor leads back, two bits each
  uint8_t parent : 7;
  bool in_sink_tree : 1;

  uint8_t Mirror(int arc) const { return mirrors >> (2 * arc) & 3; }
};

// The nodes and arcs of a cut, and the flow.
struct FlowNetwork {
  NeighborView neighbors;
  std::vector<FlowNode> nodes;
};

// The flow through a region that is solved, and its last time stamp.
struct Solved {
  int64_t flow = 0;
  uint32_t time = 0;  // not before any at which a node got its distance
};

// A distance as a node holds it. Those beyond count as one: distances choose
// between parents, nothing depends on them.
uint16_t Near(uint32_t distance) {
  return static_cast<uint16_t>(std::min<uint32_t>(distance, UINT16_MAX));
}

// Augments paths along two search trees [Boykov2004] within a region of a
// network: consecutive nodes and the arcs between them. The solver of a larger
// region around it starts from the resulting flow and trees.
class RegionSolver {
 public:
  // \param start  its time is later than all at which nodes got distances
  RegionSolver(FlowNetwork* network, uint32_t begin, uint32_t end,
               const Solved& start)
      : neighbors_(network->neighbors),
        nodes_(network->nodes.data()),
        begin_(begin),
        size_(end - begin),
        solved_(start) {}

  // Makes the nodes in trees active; of a region of two that are solved those
  // with arcs from one to the other.
  // \param middle  the first node of the second one; the first of all: there
  //        are no two
  void ActivateTrees(uint32_t middle) {
    for (uint32_t i = begin_; i < begin_ + size_; ++i) {
      if (nodes_[i].parent != kNoParent &&
          (middle == begin_ ||
           std::ranges::any_of(neighbors_[i], [&](uint32_t other) {
             return IsInside(other) && (other < middle) != (i < middle);
           }))) {
        Activate(i);
      }
    }
  }

  // \return from the start on
  Solved Run() {
    while (first_active_ != kNone) {
      const uint32_t node = first_active_;
      if (nodes_[node].parent == kNoParent || !Grow(node)) {
        PopActive();
      }
    }
    return solved_;
  }

 private:
  bool IsInside(uint32_t node) const { return node - begin_ < size_; }

  void Activate(uint32_t index) {
    if (nodes_[index].next_active != kNone) {
      return;
    }
    nodes_[index].next_active = index;
    if (first_active_ == kNone) {
      first_active_ = index;
    } else {
      nodes_[last_active_].next_active = index;
    }
    last_active_ = index;
  }

  void PopActive() {
    const uint32_t next =
        std::exchange(nodes_[first_active_].next_active, kNone);
    first_active_ = next != first_active_ ? next : kNone;
  }

  // The residual capacity between a node and its neighbor k in the direction in
  // which flow passes in the node's tree from the node to the neighbor's side:
  // away from the source, or from the neighbor towards the sink.
  int32_t Outward(const FlowNode& node, int k, const FlowNode& neighbor) const {
    return node.in_sink_tree ? neighbor.residual[node.Mirror(k)]
                             : node.residual[k];
  }

  int32_t Inward(const FlowNode& node, int k, const FlowNode& neighbor) const {
    return node.in_sink_tree ? node.residual[k]
                             : neighbor.residual[node.Mirror(k)];
  }

  // Lets the tree grow from an active node. Where it meets the other tree, flow
  // is augmented and the trees are repaired.
  // \return whether it met the other tree; the node stays active then.
  bool Grow(uint32_t index) {
    FlowNode& node = nodes_[index];
    for (int k = 0; k < 4; ++k) {
      const uint32_t other = neighbors_[index][k];
      if (!IsInside(other)) {
        continue;
      }
      FlowNode& neighbor = nodes_[other];
      if (Outward(node, k, neighbor) == 0) {
        continue;
      }
      if (neighbor.parent == kNoParent) {
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

  static void Adopt(FlowNode* child, const FlowNode& parent,
                    int arc_of_parent) {
    child->parent = parent.Mirror(arc_of_parent);
    child->distance = Near(parent.distance + 1u);
    child->stamp = parent.stamp;
  }

  // Pushes as much as fits from the source to the sink over the arc from a node
  // of the source's tree to one of the sink's.
  void Augment(uint32_t from, int arc) {
    const uint32_t to = neighbors_[from][arc];
    const int32_t amount = std::min(
        {nodes_[from].residual[arc], Bottleneck(from), Bottleneck(to)});
    nodes_[from].residual[arc] -= amount;
    nodes_[to].residual[nodes_[from].Mirror(arc)] += amount;
    Push(from, amount);
    Push(to, amount);
    solved_.flow += amount;
    ++solved_.time;
    for (size_t i = 0; i < orphans_.size(); ++i) {
      FindParent(orphans_[i]);
    }
    orphans_.clear();
  }

  int32_t Bottleneck(uint32_t index) const {
    int32_t amount = std::numeric_limits<int32_t>::max();
    for (;;) {
      const FlowNode& node = nodes_[index];
      if (node.parent == kTerminalParent) {
        return std::min(amount, std::abs(node.terminal));
      }
      const uint32_t parent = neighbors_[index][node.parent];
      amount = std::min(amount, Inward(node, node.parent, nodes_[parent]));
      index = parent;
    }
  }

  // Augments the path between a node and its tree's terminal. Nodes whose arc
  // to the parent becomes saturated become orphans.
  void Push(uint32_t index, int32_t amount) {
    for (;;) {
      FlowNode& node = nodes_[index];
      const uint8_t arc = node.parent;
      if (arc == kTerminalParent) {
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
    nodes_[index].parent = kOrphanParent;
    orphans_.push_back(index);
  }

  // Adoption [Boykov2004]: connects an orphan to the neighbor in its tree that
  // is nearest to the terminal. Without such a neighbor the node becomes free,
  // and its children become orphans.
  void FindParent(uint32_t index) {
    FlowNode& node = nodes_[index];
    uint32_t nearest = kNone;
    for (int k = 0; k < 4; ++k) {
      const uint32_t other = neighbors_[index][k];
      if (!IsInside(other) || nodes_[other].parent == kNoParent ||
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
      node.stamp = solved_.time;
      return;
    }
    node.parent = kNoParent;
    for (int k = 0; k < 4; ++k) {
      const uint32_t other = neighbors_[index][k];
      if (!IsInside(other) || nodes_[other].parent == kNoParent ||
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

  // The length of the path to the terminal, or kNone if it ends in an orphan.
  // Stores the distances of all nodes on the path for later calls.
  uint32_t DistanceToTerminal(uint32_t index) {
    uint32_t distance = 0;
    uint32_t at = index;
    while (nodes_[at].stamp != solved_.time) {
      FlowNode& node = nodes_[at];
      if (node.parent == kOrphanParent) {
        return kNone;
      }
      if (node.parent == kTerminalParent) {
        node.stamp = solved_.time;
        node.distance = 1;
      } else {
        ++distance;
        at = neighbors_[at][node.parent];
      }
    }
    distance += nodes_[at].distance;
    uint32_t remaining = distance;
    for (at = index; nodes_[at].stamp != solved_.time;
         at = neighbors_[at][nodes_[at].parent]) {
      nodes_[at].stamp = solved_.time;
      nodes_[at].distance = Near(remaining--);
    }
    return distance;
  }

  const NeighborView neighbors_;
  FlowNode* const nodes_;
  const uint32_t begin_;
  const uint32_t size_;
  std::vector<uint32_t> orphans_;
  uint32_t first_active_ = kNone;
  uint32_t last_active_ = kNone;
  Solved solved_;
};

// Solves both halves of a region in parallel, and then continues from the
// border between them [Liu2010].
// \param begin, end  consecutive nodes; the arcs between them count
Solved SolveRegion(uint32_t begin, uint32_t end, FlowNetwork* network) {
  // So large that few paths lead from region to region.
  constexpr uint32_t kMinRegion = 1 << 16;
  if (end - begin < 2 * kMinRegion) {
    RegionSolver solver(network, begin, end, {});
    solver.ActivateTrees(begin);
    return solver.Run();
  }
  const uint32_t middle = begin + (end - begin) / 2;
  Solved first;
  Solved second;
  tbb::parallel_invoke([&] { first = SolveRegion(begin, middle, network); },
                       [&] { second = SolveRegion(middle, end, network); });
  RegionSolver solver(
      network, begin, end,
      {first.flow + second.flow, std::max(first.time, second.time) + 1});
  solver.ActivateTrees(middle);
  return solver.Run();
}

int32_t Clamp(uint32_t capacity) {
  return static_cast<int32_t>(std::min(capacity, kMaxCapacity));
}

// Nothing flows; nodes with a terminal are in its tree.
void InitializeNode(const NodeCapacities& capacities, uint32_t index,
                    FlowNetwork* network) {
  const auto& row = network->neighbors[index];
  FlowNode& node = network->nodes[index];
  node.mirrors = 0;
  for (int k = 0; k < 4; ++k) {
    node.residual[k] = Clamp(capacities.arcs[k]);
    if (row[k] != kNone) {
      const auto& others = network->neighbors[row[k]];
      const auto back = std::ranges::find(others, index);
      assert(back != others.end());
      node.mirrors |= static_cast<uint8_t>((back - others.begin()) << (2 * k));
    }
  }
  node.terminal = Clamp(capacities.source) - Clamp(capacities.sink);
  node.in_sink_tree = node.terminal < 0;
  node.parent = node.terminal != 0 ? kTerminalParent : kNoParent;
  node.distance = 1;
  node.stamp = 0;
  node.next_active = kNone;
}

}  // namespace

MinCut ComputeMinCut(NeighborView neighbors, const FlowCapacities& capacities) {
  const auto num_nodes = static_cast<uint32_t>(capacities.size());
  FlowNetwork network{neighbors, std::vector<FlowNode>(num_nodes)};
  tbb::parallel_for(uint32_t{0}, num_nodes, [&](uint32_t i) {
    InitializeNode(capacities[i], i, &network);
  });
  MinCut cut;
  cut.flow = SolveRegion(0, num_nodes, &network).flow;
  for (const NodeCapacities& node : capacities) {
    // What goes straight through the node.
    cut.flow += std::min(Clamp(node.source), Clamp(node.sink));
  }
  cut.on_source_side.resize(num_nodes);
  std::ranges::transform(
      network.nodes, cut.on_source_side.begin(), [](const FlowNode& node) {
        return node.parent != kNoParent && !node.in_sink_tree;
      });
  return cut;
}

int64_t CutValue(NeighborView neighbors, const FlowCapacities& capacities,
                 const std::vector<uint8_t>& on_source_side) {
  int64_t value = 0;
  for (size_t i = 0; i < capacities.size(); ++i) {
    if (!on_source_side[i]) {
      value += Clamp(capacities[i].source);
      continue;
    }
    value += Clamp(capacities[i].sink);
    for (int k = 0; k < 4; ++k) {
      const uint32_t other = neighbors[i][k];
      if (other != kNone && !on_source_side[other]) {
        value += Clamp(capacities[i].arcs[k]);
      }
    }
  }
  return value;
}

}  // namespace colmap_ext
