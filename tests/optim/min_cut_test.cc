#include "optim/min_cut.h"

#include <algorithm>
#include <limits>

#include <gtest/gtest.h>
#if defined(__GNUC__) && !defined(__clang__)  // False alarm within Boost.
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif
#include <boost/graph/adjacency_list.hpp>
#include <boost/graph/boykov_kolmogorov_max_flow.hpp>
#include <boost/graph/push_relabel_max_flow.hpp>

#include "base/indices.h"
#include "tests/random.h"

namespace colmap_ext::min_cut_test {

struct Graph {
  std::vector<std::array<uint32_t, 4>> neighbors;
  FlowCapacities nodes;

  uint32_t size() const { return static_cast<uint32_t>(nodes.size()); }
  MinCut Cut() const { return ComputeMinCut(neighbors, nodes); }
  int64_t Value(const std::vector<uint8_t>& side) const {
    return CutValue(neighbors, nodes, side);
  }
};

// Which capacities a random graph has.
enum class Capacities { kTiny, kWide, kHuge, kMostlyZero };

constexpr Capacities kAllCapacities[] = {Capacities::kTiny, Capacities::kWide,
                                         Capacities::kHuge,
                                         Capacities::kMostlyZero};

uint32_t RandomCapacity(Capacities kind, Random* random) {
  switch (kind) {
    case Capacities::kTiny:
      return random->Below(4);
    case Capacities::kWide:
      return random->Below(1u << random->Below(20));
    case Capacities::kHuge:
      return random->Chance(0.2) ? 0
                                 : kMaxCapacity - 2 + random->Below(5) +
                                       (random->Chance(0.2) ? kMaxCapacity : 0);
    case Capacities::kMostlyZero:
      return random->Chance(0.8) ? 0 : random->Below(10);
  }
  return 0;
}

int FreeSlot(const Graph& graph, uint32_t node, Random* random) {
  const int first = random->Integer(0, 3);
  for (int k = 0; k < 4; ++k) {
    const int slot = (first + k) % 4;
    if (graph.neighbors[node][slot] == kNone) {
      return slot;
    }
  }
  return -1;
}

// Nodes of degree 0 ... 4, neighbors in slots anywhere.
Graph RandomGraph(uint32_t num_nodes, uint32_t num_edges, Capacities kind,
                  Random* random) {
  Graph graph;
  graph.neighbors.assign(num_nodes, {kNone, kNone, kNone, kNone});
  graph.nodes.assign(num_nodes, {{7, 7, 7, 7}});  // arcs of none: ignored
  for (uint32_t i = 0; i < num_edges; ++i) {
    const uint32_t u = random->Below(num_nodes);
    const uint32_t v = random->Below(num_nodes);
    const int slot_u = FreeSlot(graph, u, random);
    const int slot_v = FreeSlot(graph, v, random);
    const auto& row = graph.neighbors[u];
    if (u == v || slot_u < 0 || slot_v < 0 ||
        std::ranges::find(row, v) != row.end()) {
      continue;
    }
    graph.neighbors[u][slot_u] = v;
    graph.neighbors[v][slot_v] = u;
    graph.nodes[u].arcs[slot_u] = RandomCapacity(kind, random);
    graph.nodes[v].arcs[slot_v] = RandomCapacity(kind, random);
  }
  for (NodeCapacities& node : graph.nodes) {
    node.source = random->Chance(0.4) ? RandomCapacity(kind, random) : 0;
    node.sink = random->Chance(0.4) ? RandomCapacity(kind, random) : 0;
  }
  return graph;
}

int64_t Clamp(uint32_t capacity) { return std::min(capacity, kMaxCapacity); }

// The value of a cut, from its definition.
int64_t ValueOf(const Graph& graph, const std::vector<uint8_t>& side) {
  int64_t value = 0;
  for (uint32_t i = 0; i < graph.size(); ++i) {
    value +=
        side[i] ? Clamp(graph.nodes[i].sink) : Clamp(graph.nodes[i].source);
    for (int k = 0; k < 4; ++k) {
      const uint32_t other = graph.neighbors[i][k];
      if (other != kNone && side[i] && !side[other]) {
        value += Clamp(graph.nodes[i].arcs[k]);
      }
    }
  }
  return value;
}

// The minimum over all labelings, each of which CutValue() tells, and what all
// minimum cuts have in common on the source's side.
MinCut BruteForce(const Graph& graph) {
  MinCut best;
  best.flow = std::numeric_limits<int64_t>::max();
  std::vector<uint8_t> side(graph.size());
  for (uint32_t labels = 0; labels < 1u << graph.size(); ++labels) {
    for (uint32_t i = 0; i < graph.size(); ++i) {
      side[i] = labels >> i & 1;
    }
    const int64_t value = ValueOf(graph, side);
    EXPECT_EQ(graph.Value(side), value);
    if (value < best.flow) {
      best.flow = value;
      best.on_source_side = side;
    } else if (value == best.flow) {
      for (uint32_t i = 0; i < graph.size(); ++i) {
        best.on_source_side[i] &= side[i];
      }
    }
  }
  return best;
}

TEST(MinCut, IsTheSmallestOfAllMinimumCuts) {
  Random random(1);
  for (const Capacities kind : kAllCapacities) {
    for (int trial = 0; trial < 600; ++trial) {
      const uint32_t num_nodes = 1 + random.Below(9);
      const Graph graph =
          RandomGraph(num_nodes, random.Below(3 * num_nodes), kind, &random);
      const MinCut cut = graph.Cut();
      const MinCut expected = BruteForce(graph);
      ASSERT_EQ(cut.flow, expected.flow);
      ASSERT_EQ(cut.on_source_side, expected.on_source_side);
    }
  }
}

// The flow by two of another library's algorithms.
std::array<int64_t, 2> FlowsByBoost(const Graph& graph) {
  using Traits =
      boost::adjacency_list_traits<boost::vecS, boost::vecS, boost::directedS>;
  using Edge = Traits::edge_descriptor;
  using BoostGraph = boost::adjacency_list<
      boost::vecS, boost::vecS, boost::directedS,
      boost::property<
          boost::vertex_index_t, long,
          boost::property<
              boost::vertex_color_t, boost::default_color_type,
              boost::property<
                  boost::vertex_distance_t, long,
                  boost::property<boost::vertex_predecessor_t, Edge>>>>,
      boost::property<
          boost::edge_capacity_t, int64_t,
          boost::property<boost::edge_residual_capacity_t, int64_t,
                          boost::property<boost::edge_reverse_t, Edge>>>>;
  const uint32_t size = graph.size();
  BoostGraph flow_graph(size + 2);
  const auto capacities = get(boost::edge_capacity, flow_graph);
  const auto reverses = get(boost::edge_reverse, flow_graph);
  const auto connect = [&](uint32_t u, uint32_t v, uint32_t capacity) {
    const Edge edge = add_edge(u, v, flow_graph).first;
    const Edge back = add_edge(v, u, flow_graph).first;
    capacities[edge] = std::min(capacity, kMaxCapacity);
    capacities[back] = 0;
    reverses[edge] = back;
    reverses[back] = edge;
  };
  for (uint32_t i = 0; i < size; ++i) {
    connect(size, i, graph.nodes[i].source);
    connect(i, size + 1, graph.nodes[i].sink);
    for (int k = 0; k < 4; ++k) {
      if (graph.neighbors[i][k] != kNone) {
        connect(i, graph.neighbors[i][k], graph.nodes[i].arcs[k]);
      }
    }
  }
  return {boykov_kolmogorov_max_flow(flow_graph, size, size + 1),
          push_relabel_max_flow(flow_graph, size, size + 1)};
}

TEST(MinCut, AgreesWithBoostOnLargerGraphs) {
  Random random(3);
  for (const Capacities kind : kAllCapacities) {
    for (int trial = 0; trial < 5; ++trial) {
      const Graph graph = RandomGraph(2000, 8000, kind, &random);
      const MinCut cut = graph.Cut();
      for (const int64_t expected : FlowsByBoost(graph)) {
        ASSERT_EQ(cut.flow, expected);
      }
      ASSERT_EQ(cut.flow, ValueOf(graph, cut.on_source_side));
    }
  }
}

// Cuts a graph, and the same graph with other numbers of nodes and slots.
void ExpectSameWithOtherNumbers(const Graph& graph, Random* random) {
  const MinCut cut = graph.Cut();
  EXPECT_EQ(graph.Value(cut.on_source_side), cut.flow);
  const std::vector<uint32_t> number = random->Permutation(graph.size());
  Graph renumbered = graph;
  for (uint32_t i = 0; i < graph.size(); ++i) {
    renumbered.nodes[number[i]] = graph.nodes[i];
    const uint32_t rotation = random->Below(4);  // of the slots
    for (uint32_t k = 0; k < 4; ++k) {
      const uint32_t other = graph.neighbors[i][k];
      const uint32_t slot = (k + rotation) % 4;
      renumbered.neighbors[number[i]][slot] =
          other == kNone ? kNone : number[other];
      renumbered.nodes[number[i]].arcs[slot] = graph.nodes[i].arcs[k];
    }
  }
  const MinCut other_cut = renumbered.Cut();
  EXPECT_EQ(other_cut.flow, cut.flow);
  for (uint32_t i = 0; i < graph.size(); ++i) {
    ASSERT_EQ(other_cut.on_source_side[number[i]], cut.on_source_side[i]);
  }
}

// The larger ones have regions that are cut side by side, four of them.
TEST(MinCut, DoesNotDependOnTheNumbering) {
  Random random(4);
  for (const Capacities kind : kAllCapacities) {
    ExpectSameWithOtherNumbers(RandomGraph(3000, 12000, kind, &random),
                               &random);
  }
  for (const Capacities kind : {Capacities::kWide, Capacities::kMostlyZero}) {
    ExpectSameWithOtherNumbers(RandomGraph(270000, 700000, kind, &random),
                               &random);
  }
}

// On a chain the minimum is found by dynamic programming. The flow has a long
// way to go.
TEST(MinCut, LongChain) {
  constexpr uint32_t kNumNodes = 50000;
  Random random(5);
  Graph graph;
  for (uint32_t i = 0; i < kNumNodes; ++i) {
    graph.neighbors.push_back({i == 0 ? kNone : i - 1, kNone,
                               i + 1 == kNumNodes ? kNone : i + 1, kNone});
    NodeCapacities& node = graph.nodes.emplace_back();
    node.arcs = {random.Below(1000), 0, random.Below(1000), 0};
    if (i % 1000 == 0) {
      (random.Chance(0.5) ? node.source : node.sink) = random.Below(2000);
    }
  }
  // The least value of the first nodes' cut, the last of them on the sink's
  // side and on the source's.
  std::array<int64_t, 2> least = {0, 0};
  for (uint32_t i = 0; i < kNumNodes; ++i) {
    const int64_t falling = i == 0 ? 0 : graph.nodes[i - 1].arcs[2];
    const int64_t rising = i == 0 ? 0 : graph.nodes[i].arcs[0];
    least = {std::min(least[0], least[1] + falling) + graph.nodes[i].source,
             std::min(least[1], least[0] + rising) + graph.nodes[i].sink};
  }
  const MinCut cut = graph.Cut();
  EXPECT_EQ(cut.flow, std::min(least[0], least[1]));
  EXPECT_EQ(graph.Value(cut.on_source_side), cut.flow);
}

TEST(MinCut, LargestCapacitiesDoNotOverflowAndNoNodesHaveNoFlow) {
  constexpr uint32_t kLargest = std::numeric_limits<uint32_t>::max();
  Graph graph;
  graph.neighbors = {{1, kNone, kNone, kNone}, {0, kNone, kNone, kNone}};
  graph.nodes = {{{kLargest, 0, 0, 0}, kLargest, 0},
                 {{kLargest, 0, 0, 0}, 0, kLargest}};
  const MinCut cut = graph.Cut();
  EXPECT_EQ(cut.flow, int64_t{kMaxCapacity});
  EXPECT_EQ(graph.Value(cut.on_source_side), cut.flow);
  const MinCut none = Graph().Cut();
  EXPECT_EQ(none.flow, 0);
  EXPECT_TRUE(none.on_source_side.empty());
}

}  // namespace colmap_ext::min_cut_test
