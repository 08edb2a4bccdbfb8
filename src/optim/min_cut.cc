#include "optim/min_cut.h"

#include <algorithm>
#include <cassert>

#include <tbb/parallel_for.h>

#include "optim/region_solver.h"

namespace colmap_ext {
namespace {

int32_t Clamp(uint32_t capacity) {
  return static_cast<int32_t>(std::min(capacity, kMaxCapacity));
}

// Nothing flows; nodes with a terminal are in its tree.
void InitializeNode(const FlowCapacities& graph, uint32_t index,
                    FlowNetwork* network) {
  const auto& row = network->neighbors[index];
  FlowNode& node = network->nodes[index];
  node.mirrors = 0;
  for (int k = 0; k < 4; ++k) {
    node.residual[k] = Clamp(graph.capacities[index][k]);
    if (row[k] != kNone) {
      const auto& others = network->neighbors[row[k]];
      const auto back = std::ranges::find(others, index);
      assert(back != others.end());
      node.mirrors |= static_cast<uint8_t>((back - others.begin()) << (2 * k));
    }
  }
  node.terminal = Clamp(graph.source[index]) - Clamp(graph.sink[index]);
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
    InitializeNode(capacities, i, &network);
  });
  MinCut cut;
  cut.flow = SolveRegion(0, num_nodes, &network).flow;
  for (uint32_t i = 0; i < num_nodes; ++i) {
    // What goes straight through the node.
    cut.flow +=
        std::min(Clamp(capacities.source[i]), Clamp(capacities.sink[i]));
  }
  cut.on_source_side.resize(num_nodes);
  std::ranges::transform(
      network.nodes, cut.on_source_side.begin(), [](const FlowNode& node) {
        return node.parent != kNoParent && !node.in_sink_tree;
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
      if (other != kNone && !on_source_side[other]) {
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
