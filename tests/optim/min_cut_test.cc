#include "optim/min_cut.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include <gtest/gtest.h>
#if defined(__GNUC__) && !defined(__clang__)  // False alarm within Boost.
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif
#include <boost/graph/adjacency_list.hpp>
#include <boost/graph/boykov_kolmogorov_max_flow.hpp>
#include <boost/graph/push_relabel_max_flow.hpp>

#include "tests/random.h"

namespace colmap_ext {
namespace min_cut_test {

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

int FreeSlot(const FlowGraph& graph, uint32_t node, Random* random) {
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
FlowGraph RandomGraph(uint32_t num_nodes, uint32_t num_edges, Capacities kind,
                      Random* random) {
  FlowGraph graph;
  graph.neighbors.assign(num_nodes, {kNone, kNone, kNone, kNone});
  graph.capacities.assign(num_nodes, {7, 7, 7, 7});  // of no arc: no matter
  for (uint32_t i = 0; i < num_edges; ++i) {
    const uint32_t u = random->Below(num_nodes);
    const uint32_t v = random->Below(num_nodes);
    const int slot_u = FreeSlot(graph, u, random);
    const int slot_v = FreeSlot(graph, v, random);
    const auto& row = graph.neighbors[u];
    if (u == v || slot_u < 0 || slot_v < 0 ||
        std::find(row.begin(), row.end(), v) != row.end()) {
      continue;
    }
    graph.neighbors[u][slot_u] = v;
    graph.neighbors[v][slot_v] = u;
    graph.capacities[u][slot_u] = RandomCapacity(kind, random);
    graph.capacities[v][slot_v] = RandomCapacity(kind, random);
  }
  for (uint32_t i = 0; i < num_nodes; ++i) {
    graph.source.push_back(random->Chance(0.4) ? RandomCapacity(kind, random)
                                               : 0);
    graph.sink.push_back(random->Chance(0.4) ? RandomCapacity(kind, random)
                                             : 0);
  }
  return graph;
}

int64_t Clamp(uint32_t capacity) { return std::min(capacity, kMaxCapacity); }

// The value of a cut, from its definition.
int64_t ValueOf(const FlowGraph& graph, const std::vector<uint8_t>& side) {
  int64_t value = 0;
  for (uint32_t i = 0; i < graph.size(); ++i) {
    value += side[i] ? Clamp(graph.sink[i]) : Clamp(graph.source[i]);
    for (int k = 0; k < 4; ++k) {
      const uint32_t other = graph.neighbors[i][k];
      if (other != kNone && side[i] && !side[other]) {
        value += Clamp(graph.capacities[i][k]);
      }
    }
  }
  return value;
}

// The minimum over all labelings, and what all minimum cuts have in common on
// the source's side.
MinCut BruteForce(const FlowGraph& graph) {
  MinCut best;
  best.flow = std::numeric_limits<int64_t>::max();
  std::vector<uint8_t> side(graph.size());
  for (uint32_t labels = 0; labels < 1u << graph.size(); ++labels) {
    for (uint32_t i = 0; i < graph.size(); ++i) {
      side[i] = labels >> i & 1;
    }
    const int64_t value = ValueOf(graph, side);
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
      const FlowGraph graph =
          RandomGraph(num_nodes, random.Below(3 * num_nodes), kind, &random);
      const MinCut cut = ComputeMinCut(graph);
      const MinCut expected = BruteForce(graph);
      ASSERT_EQ(cut.flow, expected.flow);
      ASSERT_EQ(cut.on_source_side, expected.on_source_side);
    }
  }
}

TEST(MinCut, CutValueIsTheSumOfTheCutArcs) {
  Random random(2);
  for (const Capacities kind : kAllCapacities) {
    for (int trial = 0; trial < 50; ++trial) {
      const FlowGraph graph = RandomGraph(20, 60, kind, &random);
      std::vector<uint8_t> side(graph.size());
      for (uint8_t& label : side) {
        label = random.Chance(0.5);
      }
      ASSERT_EQ(CutValue(graph, side), ValueOf(graph, side));
    }
  }
}

// The flow by another library's algorithms.
struct BoostFlows {
  int64_t boykov_kolmogorov;
  int64_t push_relabel;
};

BoostFlows FlowsByBoost(const FlowGraph& graph) {
  using Traits =
      boost::adjacency_list_traits<boost::vecS, boost::vecS, boost::directedS>;
  using Edge = Traits::edge_descriptor;
  using Graph = boost::adjacency_list<
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
  const auto size = static_cast<uint32_t>(graph.size());
  Graph flow_graph(size + 2);
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
    connect(size, i, graph.source[i]);
    connect(i, size + 1, graph.sink[i]);
    for (int k = 0; k < 4; ++k) {
      if (graph.neighbors[i][k] != kNone) {
        connect(i, graph.neighbors[i][k], graph.capacities[i][k]);
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
      const FlowGraph graph = RandomGraph(2000, 8000, kind, &random);
      const MinCut cut = ComputeMinCut(graph);
      const BoostFlows expected = FlowsByBoost(graph);
      ASSERT_EQ(cut.flow, expected.boykov_kolmogorov);
      ASSERT_EQ(cut.flow, expected.push_relabel);
      ASSERT_EQ(cut.flow, ValueOf(graph, cut.on_source_side));
    }
  }
}

// Cuts a graph, and the same graph with other numbers of nodes and slots.
void ExpectSameWithOtherNumbers(const FlowGraph& graph, Random* random) {
  const MinCut cut = ComputeMinCut(graph);
  EXPECT_EQ(CutValue(graph, cut.on_source_side), cut.flow);
  std::vector<uint32_t> number(graph.size());
  std::iota(number.begin(), number.end(), 0);
  random->Shuffle(&number);
  FlowGraph renumbered = graph;
  for (uint32_t i = 0; i < graph.size(); ++i) {
    const uint32_t rotation = random->Below(4);  // of the slots
    for (uint32_t k = 0; k < 4; ++k) {
      const uint32_t other = graph.neighbors[i][k];
      const uint32_t slot = (k + rotation) % 4;
      renumbered.neighbors[number[i]][slot] =
          other == kNone ? kNone : number[other];
      renumbered.capacities[number[i]][slot] = graph.capacities[i][k];
    }
    renumbered.source[number[i]] = graph.source[i];
    renumbered.sink[number[i]] = graph.sink[i];
  }
  const MinCut other_cut = ComputeMinCut(renumbered);
  EXPECT_EQ(other_cut.flow, cut.flow);
  for (uint32_t i = 0; i < graph.size(); ++i) {
    ASSERT_EQ(other_cut.on_source_side[number[i]], cut.on_source_side[i]);
  }
}

TEST(MinCut, DoesNotDependOnTheNumbering) {
  Random random(4);
  for (const Capacities kind : kAllCapacities) {
    ExpectSameWithOtherNumbers(RandomGraph(3000, 12000, kind, &random),
                               &random);
  }
}

// Regions that are cut side by side, four of them.
TEST(MinCut, LargeGraphsDoNotDependOnTheNumberingEither) {
  Random random(6);
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
  FlowGraph graph;
  graph.source.assign(kNumNodes, 0);
  graph.sink.assign(kNumNodes, 0);
  for (uint32_t i = 0; i < kNumNodes; ++i) {
    graph.neighbors.push_back({i == 0 ? kNone : i - 1, kNone,
                               i + 1 == kNumNodes ? kNone : i + 1, kNone});
    graph.capacities.push_back({random.Below(1000), 0, random.Below(1000), 0});
    if (i % 1000 == 0) {
      (random.Chance(0.5) ? graph.source : graph.sink)[i] = random.Below(2000);
    }
  }
  // The least value of the first nodes' cut, the last of them on the sink's
  // side and on the source's.
  std::array<int64_t, 2> least = {0, 0};
  for (uint32_t i = 0; i < kNumNodes; ++i) {
    const int64_t falling = i == 0 ? 0 : graph.capacities[i - 1][2];
    const int64_t rising = i == 0 ? 0 : graph.capacities[i][0];
    least = {std::min(least[0], least[1] + falling) + graph.source[i],
             std::min(least[1], least[0] + rising) + graph.sink[i]};
  }
  const MinCut cut = ComputeMinCut(graph);
  EXPECT_EQ(cut.flow, std::min(least[0], least[1]));
  EXPECT_EQ(CutValue(graph, cut.on_source_side), cut.flow);
}

TEST(MinCut, LargestCapacitiesDoNotOverflow) {
  constexpr uint32_t kLargest = std::numeric_limits<uint32_t>::max();
  FlowGraph graph;
  graph.neighbors = {{1, kNone, kNone, kNone}, {0, kNone, kNone, kNone}};
  graph.capacities = {{kLargest, 0, 0, 0}, {kLargest, 0, 0, 0}};
  graph.source = {kLargest, 0};
  graph.sink = {0, kLargest};
  const MinCut cut = ComputeMinCut(graph);
  EXPECT_EQ(cut.flow, int64_t{kMaxCapacity});
  EXPECT_EQ(CutValue(graph, cut.on_source_side), cut.flow);
}

TEST(MinCut, EmptyGraph) {
  const MinCut cut = ComputeMinCut(FlowGraph());
  EXPECT_EQ(cut.flow, 0);
  EXPECT_TRUE(cut.on_source_side.empty());
}

}  // namespace min_cut_test
}  // namespace colmap_ext
