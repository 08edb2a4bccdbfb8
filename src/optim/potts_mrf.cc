#include "optim/potts_mrf.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace colmap_ext {

namespace {

// The nodes' order in which messages are passed: breadth first, so that chains
// of growing order run through the whole graph.
std::vector<uint32_t> BreadthFirstOrder(const PottsProblem& problem) {
  std::vector<uint32_t> order;
  order.reserve(problem.NumNodes());
  std::vector<bool> is_reached(problem.NumNodes(), false);
  for (uint32_t seed = 0; seed < problem.NumNodes(); ++seed) {
    if (is_reached[seed]) {
      continue;
    }
    is_reached[seed] = true;
    order.push_back(seed);
    for (size_t next = order.size() - 1; next < order.size(); ++next) {
      for (const uint32_t neighbor : problem.neighbors[order[next]]) {
        if (neighbor != UINT32_MAX && !is_reached[neighbor]) {
          is_reached[neighbor] = true;
          order.push_back(neighbor);
        }
      }
    }
  }
  return order;
}

// The field with its nodes in the order of the passes.
class MessagePassing {
 public:
  explicit MessagePassing(const PottsProblem& problem)
      : problem_(problem),
        order_(BreadthFirstOrder(problem)),
        ranks_(problem.NumNodes()),
        weight_(static_cast<float>(problem.weight)) {
    for (uint32_t i = 0; i < order_.size(); ++i) {
      ranks_[order_[i]] = i;
    }
    AllocateMessages();
  }

  // A pass along the order; each node chooses by the earlier ones' choices and
  // the later ones' messages.
  void Forward(std::vector<uint32_t>* choices) {
    for (const uint32_t node : order_) {
      if (NumLabels(node) == 0) {
        continue;
      }
      Choose(node, choices);
      Collect(node);
      Send(node, true);
    }
  }

  // A pass against the order. Returns a lower bound on the energy.
  double Backward() {
    double bound = 0;
    for (size_t i = order_.size(); i-- > 0;) {
      const uint32_t node = order_[i];
      if (NumLabels(node) == 0) {
        continue;
      }
      Collect(node);
      const float least = *std::min_element(belief_.begin(), belief_.end());
      for (float& belief : belief_) {
        belief -= least;
      }
      bound += least + Send(node, false);
    }
    return bound;
  }

 private:
  uint32_t NumLabels(uint32_t node) const {
    return static_cast<uint32_t>(problem_.offsets[node + 1] -
                                 problem_.offsets[node]);
  }

  const uint32_t* Labels(uint32_t node) const {
    return problem_.labels.data() + problem_.offsets[node];
  }

  const float* Costs(uint32_t node) const {
    return problem_.costs.data() + problem_.offsets[node];
  }

  bool IsUsed(uint32_t neighbor) const {
    return neighbor != UINT32_MAX && NumLabels(neighbor) > 0;
  }

  // An edge has one message at a time, to the node whose turn comes next; it is
  // kept with the node that is first in the order.
  void AllocateMessages() {
    messages_of_.assign(problem_.NumNodes(), {});
    uint64_t size = 0;
    for (uint32_t node = 0; node < problem_.NumNodes(); ++node) {
      for (int k = 0; k < 3; ++k) {
        const uint32_t neighbor = problem_.neighbors[node][k];
        if (!IsUsed(neighbor) || ranks_[neighbor] < ranks_[node]) {
          continue;
        }
        const auto& back = problem_.neighbors[neighbor];
        const auto place =
            std::find(back.begin(), back.end(), node) - back.begin();
        messages_of_[node][k] = size;
        messages_of_[neighbor][place] = size;
        size += std::max(NumLabels(node), NumLabels(neighbor));
      }
    }
    messages_.assign(size, 0);
  }

  // The node's costs and the messages of all its neighbors.
  void Collect(uint32_t node) {
    belief_.assign(Costs(node), Costs(node) + NumLabels(node));
    for (int k = 0; k < 3; ++k) {
      if (IsUsed(problem_.neighbors[node][k])) {
        const float* message = messages_.data() + messages_of_[node][k];
        for (size_t i = 0; i < belief_.size(); ++i) {
          belief_[i] += message[i];
        }
      }
    }
  }

  // Replaces the messages on the edges to the later (or earlier) neighbors by
  // those to them. Returns what is subtracted from these so that they are 0 at
  // least.
  double Send(uint32_t node, bool is_forward) {
    int num_later = 0;
    int num_earlier = 0;
    for (const uint32_t neighbor : problem_.neighbors[node]) {
      if (IsUsed(neighbor)) {
        ++(ranks_[neighbor] > ranks_[node] ? num_later : num_earlier);
      }
    }
    const float share =
        1 / static_cast<float>(std::max({num_later, num_earlier, 1}));
    double subtracted = 0;
    for (int k = 0; k < 3; ++k) {
      const uint32_t neighbor = problem_.neighbors[node][k];
      if (IsUsed(neighbor) && (ranks_[neighbor] > ranks_[node]) == is_forward) {
        subtracted += SendTo(node, neighbor, share,
                             messages_.data() + messages_of_[node][k]);
      }
    }
    return subtracted;
  }

  // The message to a label is the least of what the node's labels cost, plus
  // the weight for all but the same label.
  float SendTo(uint32_t node, uint32_t neighbor, float share, float* message) {
    const uint32_t num_labels = NumLabels(node);
    reduced_.resize(num_labels);
    float least = std::numeric_limits<float>::max();
    for (uint32_t i = 0; i < num_labels; ++i) {
      reduced_[i] = share * belief_[i] - message[i];
      least = std::min(least, reduced_[i]);
    }
    const float other = least + weight_;
    const uint32_t* from = Labels(node);
    const uint32_t* to = Labels(neighbor);
    const uint32_t num_to = NumLabels(neighbor);
    float lowest = other;
    for (uint32_t i = 0, j = 0; j < num_to; ++j) {
      while (i < num_labels && from[i] < to[j]) {
        ++i;
      }
      const bool is_common = i < num_labels && from[i] == to[j];
      message[j] = is_common ? std::min(reduced_[i], other) : other;
      lowest = j == 0 ? message[j] : std::min(lowest, message[j]);
    }
    for (uint32_t j = 0; j < num_to; ++j) {
      message[j] -= lowest;
    }
    return lowest;
  }

  void Choose(uint32_t node, std::vector<uint32_t>* choices) {
    belief_.assign(Costs(node), Costs(node) + NumLabels(node));
    for (int k = 0; k < 3; ++k) {
      const uint32_t neighbor = problem_.neighbors[node][k];
      if (!IsUsed(neighbor)) {
        continue;
      }
      if (ranks_[neighbor] < ranks_[node]) {
        const uint32_t label = Labels(neighbor)[(*choices)[neighbor]];
        for (size_t i = 0; i < belief_.size(); ++i) {
          belief_[i] += Labels(node)[i] == label ? 0 : weight_;
        }
      } else {
        const float* message = messages_.data() + messages_of_[node][k];
        for (size_t i = 0; i < belief_.size(); ++i) {
          belief_[i] += message[i];
        }
      }
    }
    (*choices)[node] = static_cast<uint32_t>(
        std::min_element(belief_.begin(), belief_.end()) - belief_.begin());
  }

  const PottsProblem& problem_;
  std::vector<uint32_t> order_;  // [N] nodes
  std::vector<uint32_t> ranks_;  // [N] of each node in the order
  float weight_;
  std::vector<std::array<uint64_t, 3>> messages_of_;  // [N] into messages_
  std::vector<float> messages_;
  std::vector<float> belief_, reduced_;  // of a node's labels, scratch
};

// What a label costs at a node whose neighbors have chosen.
double CostBeside(const PottsProblem& problem,
                  const std::vector<uint32_t>& choices, uint32_t node,
                  uint32_t choice) {
  const uint64_t at = problem.offsets[node] + choice;
  double cost = problem.costs[at];
  for (const uint32_t neighbor : problem.neighbors[node]) {
    if (neighbor != UINT32_MAX && choices[neighbor] != kNoChoice &&
        problem.labels[problem.offsets[neighbor] + choices[neighbor]] !=
            problem.labels[at]) {
      cost += problem.weight;
    }
  }
  return cost;
}

// Iterated conditional modes (Besag 1986).
void Polish(const PottsProblem& problem, std::vector<uint32_t>* choices) {
  constexpr int kMaxRounds = 10;
  for (int round = 0; round < kMaxRounds; ++round) {
    bool has_changed = false;
    for (uint32_t node = 0; node < problem.NumNodes(); ++node) {
      if ((*choices)[node] == kNoChoice) {
        continue;
      }
      double least = CostBeside(problem, *choices, node, (*choices)[node]);
      const auto num_labels = static_cast<uint32_t>(problem.offsets[node + 1] -
                                                    problem.offsets[node]);
      for (uint32_t choice = 0; choice < num_labels; ++choice) {
        const double cost = CostBeside(problem, *choices, node, choice);
        if (cost < least) {
          least = cost;
          (*choices)[node] = choice;
          has_changed = true;
        }
      }
    }
    if (!has_changed) {
      return;
    }
  }
}

std::vector<uint32_t> CheapestLabels(const PottsProblem& problem) {
  std::vector<uint32_t> choices(problem.NumNodes(), kNoChoice);
  for (size_t node = 0; node < choices.size(); ++node) {
    const auto first =
        problem.costs.begin() + static_cast<ptrdiff_t>(problem.offsets[node]);
    const auto last = problem.costs.begin() +
                      static_cast<ptrdiff_t>(problem.offsets[node + 1]);
    if (first != last) {
      choices[node] =
          static_cast<uint32_t>(std::min_element(first, last) - first);
    }
  }
  return choices;
}

}  // namespace

double PottsEnergy(const PottsProblem& problem,
                   const std::vector<uint32_t>& choices) {
  double energy = 0;
  for (uint32_t node = 0; node < problem.NumNodes(); ++node) {
    if (choices[node] == kNoChoice) {
      continue;
    }
    const uint64_t at = problem.offsets[node] + choices[node];
    energy += problem.costs[at];
    for (const uint32_t neighbor : problem.neighbors[node]) {
      if (neighbor != UINT32_MAX && neighbor > node &&
          choices[neighbor] != kNoChoice &&
          problem.labels[problem.offsets[neighbor] + choices[neighbor]] !=
              problem.labels[at]) {
        energy += problem.weight;
      }
    }
  }
  return energy;
}

PottsSolution SolvePotts(const PottsProblem& problem, double max_gap,
                         int max_iterations) {
  constexpr double kMinRise = 2e-4;  // of the bound, from pass to pass
  PottsSolution solution;
  solution.choices = CheapestLabels(problem);
  solution.initial_energy = PottsEnergy(problem, solution.choices);
  solution.energy = solution.initial_energy;
  MessagePassing passing(problem);
  std::vector<uint32_t> choices = solution.choices;
  while (solution.iterations < max_iterations) {
    ++solution.iterations;
    passing.Forward(&choices);
    const double energy = PottsEnergy(problem, choices);
    if (energy < solution.energy) {
      solution.energy = energy;
      solution.choices = choices;
    }
    const double bound = passing.Backward();
    const double rise = bound - solution.lower_bound;
    solution.lower_bound = std::max(solution.lower_bound, bound);
    if (solution.energy - solution.lower_bound <= max_gap * solution.energy ||
        (solution.iterations > 1 && rise < kMinRise * solution.lower_bound)) {
      break;
    }
  }
  Polish(problem, &solution.choices);
  solution.energy = PottsEnergy(problem, solution.choices);
  return solution;
}

}  // namespace colmap_ext
