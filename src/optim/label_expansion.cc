#include "optim/label_expansion.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include <tbb/parallel_for.h>

#include "optim/min_cut.h"

namespace colmap_ext {

namespace {

// The nodes that have each label.
struct NodesOfLabels {
  std::vector<uint64_t> offsets;  // [L + 1], into nodes
  std::vector<uint32_t> nodes;    // ascending in each row
};

NodesOfLabels FindNodes(const PottsProblem& problem) {
  uint32_t num_labels = 0;
  for (const uint32_t label : problem.labels) {
    num_labels = std::max(num_labels, label + 1);
  }
  NodesOfLabels result;
  std::vector<uint64_t>& offsets = result.offsets;
  offsets.assign(num_labels + 2, 0);
  for (const uint32_t label : problem.labels) {
    ++offsets[label + 2];
  }
  std::partial_sum(offsets.begin(), offsets.end(), offsets.begin());
  result.nodes.resize(problem.labels.size());
  for (uint32_t node = 0; node < problem.NumNodes(); ++node) {
    const uint32_t* labels = problem.Labels(node);
    for (uint32_t i = 0; i < problem.NumLabels(node); ++i) {
      result.nodes[offsets[labels[i] + 1]++] = node;
    }
  }
  offsets.pop_back();
  return result;
}

class Expansion {
 public:
  Expansion(const PottsProblem& problem, std::vector<uint32_t> choices)
      : problem_(problem),
        choices_(std::move(choices)),
        nodes_of_labels_(FindNodes(problem)),
        places_(problem.NumNodes(), kNoNeighbor) {
    float largest = 0;
    for (const float cost : problem.costs) {
      largest = std::max(largest, cost);
    }
    // A node pays for a label and for three edges at most.
    const double most = largest + 3 * problem.weight;
    scale_ = most > 0 ? kMaxCapacity / most : 0;
  }

  std::vector<uint32_t> Run() {
    for (uint32_t label = 0; label + 1 < nodes_of_labels_.offsets.size();
         ++label) {
      Expand(label);
    }
    return std::move(choices_);
  }

 private:
  // Nodes on the source's side take the label.
  void Expand(uint32_t label) {
    FindMovable(label);
    const size_t num_nodes = movable_.size();
    graph_.neighbors.assign(
        num_nodes, {kNoNeighbor, kNoNeighbor, kNoNeighbor, kNoNeighbor});
    graph_.capacities.assign(num_nodes, {});
    graph_.source.resize(num_nodes);
    graph_.sink.resize(num_nodes);
    tbb::parallel_for(size_t{0}, num_nodes,
                      [&](size_t i) { AddNode(i, label); });
    const MinCut cut = ComputeMinCut(graph_);
    for (size_t i = 0; i < num_nodes; ++i) {
      places_[movable_[i]] = kNoNeighbor;
      if (cut.on_source_side[i] != 0) {
        choices_[movable_[i]] = Place(movable_[i], label);
      }
    }
  }

  // The nodes that have the label and have not chosen it.
  void FindMovable(uint32_t label) {
    movable_.clear();
    for (uint64_t i = nodes_of_labels_.offsets[label];
         i < nodes_of_labels_.offsets[label + 1]; ++i) {
      const uint32_t node = nodes_of_labels_.nodes[i];
      if (Chosen(node) != label) {
        places_[node] = static_cast<uint32_t>(movable_.size());
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
      if (other == UINT32_MAX || choices_[other] == kNoChoice) {
        continue;
      }
      const bool differs = Chosen(other) != Chosen(node);
      if (places_[other] == kNoNeighbor) {
        keep += differs ? problem_.weight : 0;
        take += Chosen(other) != label ? problem_.weight : 0;
        continue;
      }
      const bool is_second = node > other;
      keep += differs && is_second ? problem_.weight : 0;
      graph_.neighbors[place][k] = places_[other];
      graph_.capacities[place][k] =
          differs && !is_second ? 0 : Capacity(problem_.weight);
    }
    graph_.source[place] = Capacity(keep);
    graph_.sink[place] = Capacity(take);
  }

  uint32_t Chosen(uint32_t node) const {
    return problem_.Labels(node)[choices_[node]];
  }

  uint32_t Place(uint32_t node, uint32_t label) const {
    const uint32_t* labels = problem_.Labels(node);
    return static_cast<uint32_t>(
        std::lower_bound(labels, labels + problem_.NumLabels(node), label) -
        labels);
  }

  uint32_t Capacity(double cost) const {
    return static_cast<uint32_t>(cost * scale_ + 0.5);
  }

  const PottsProblem& problem_;
  std::vector<uint32_t> choices_;
  NodesOfLabels nodes_of_labels_;
  double scale_ = 0;               // capacity of a cost of 1
  std::vector<uint32_t> movable_;  // nodes
  std::vector<uint32_t> places_;   // [N] into movable_, or kNoNeighbor
  FlowGraph graph_;                // of movable_
};

}  // namespace

std::vector<uint32_t> ExpandLabels(const PottsProblem& problem,
                                   std::vector<uint32_t> choices) {
  return Expansion(problem, std::move(choices)).Run();
}

}  // namespace colmap_ext
