#include "optim/potts_mrf.h"

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <vector>

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

namespace colmap_ext {
namespace {

using Neighbors = std::vector<std::array<uint32_t, 3>>;

// Nodes of the same class are not neighbors: 4 * level + color. The level is
// the number of edges from the nearest seed, the color the least that no
// neighbor in the same level has got before; three neighbors take three.
struct Search {
  std::vector<uint32_t> order;    // [N] nodes, those around the seeds first
  std::vector<uint32_t> classes;  // [N]
};

// Nodes for each seed of a search. With fewer, classes are larger, so that more
// threads have work, and messages run less far.
constexpr uint32_t kSeedSpacing = 2048;

Search BreadthFirst(const Neighbors& neighbors) {
  Search search;
  search.order.reserve(neighbors.size());
  search.classes.assign(neighbors.size(), kNone);
  std::vector<uint32_t> levels(neighbors.size(), kNone);
  const auto reach = [&](uint32_t node, uint32_t level) {
    if (node != kNone && levels[node] == kNone) {
      levels[node] = level;
      search.order.push_back(node);
    }
  };
  for (uint32_t seed = 0; seed < neighbors.size(); seed += kSeedSpacing) {
    reach(seed, 0);
  }
  size_t next = 0;
  for (uint32_t seed = 0; seed < neighbors.size(); ++seed) {
    reach(seed, 0);  // of a part that none of the others has reached
    for (; next < search.order.size(); ++next) {
      const uint32_t node = search.order[next];
      uint32_t color = 4 * levels[node];
      const auto is_taken = [&](uint32_t other) {
        return other != kNone && search.classes[other] == color;
      };
      while (std::ranges::any_of(neighbors[node], is_taken)) {
        ++color;
      }
      search.classes[node] = color;
      for (const uint32_t other : neighbors[node]) {
        reach(other, levels[node] + 1);
      }
    }
  }
  return search;
}

// Runs of consecutive nodes of which none is another's neighbor: [R + 1] into
// the nodes.
std::vector<uint32_t> IndependentRuns(const PottsProblem& problem) {
  std::vector<uint32_t> runs{0};
  for (uint32_t node = 0; node < problem.NumNodes(); ++node) {
    for (const uint32_t neighbor : problem.neighbors[node]) {
      if (neighbor >= runs.back() && neighbor < node) {
        runs.push_back(node);
        break;
      }
    }
  }
  runs.push_back(static_cast<uint32_t>(problem.NumNodes()));
  return runs;
}

// The passes of sequential tree-reweighted message passing [Kolmogorov2006,
// figure 3], along the nodes' own order and against it. Runs of consecutive
// nodes without neighbors among them are visited in parallel; what comes out is
// the same as one by one.
//
// A message has a value for each label of the node that it goes to; the least
// value is 0.
class MessagePassing {
 public:
  // \param problem  has to outlive this.
  explicit MessagePassing(const PottsProblem& problem)
      : problem_(problem),
        weight_(static_cast<float>(problem.weight)),
        runs_(IndependentRuns(problem)) {
    AllocateMessages();
  }

  // A pass in the order. Each node chooses by the choices of its earlier
  // neighbors and the messages of its later ones.
  // \param choices [N] see PottsSolution, are overwritten
  // \return the energy of the choices
  double Forward(std::vector<uint32_t>* choices) {
    double energy = 0;
    for (size_t run = 0; run + 1 < runs_.size(); ++run) {
      energy += SumOverRun(run, [&](uint32_t node, Scratch* scratch) {
        const double cost = Choose(node, &scratch->belief, choices);
        Collect(node, &scratch->belief);
        Send(node, true, scratch);
        return cost;
      });
    }
    return energy;
  }

  // A pass against the order.
  // \return a lower bound on the energy
  double Backward() {
    double bound = 0;
    for (size_t run = runs_.size() - 1; run-- > 0;) {
      bound += SumOverRun(run, [&](uint32_t node, Scratch* scratch) {
        std::vector<float>& belief = scratch->belief;
        Collect(node, &belief);
        const float least = *std::ranges::min_element(belief);
        for (float& value : belief) {
          value -= least;
        }
        return least + Send(node, false, scratch);
      });
    }
    return bound;
  }

 private:
  // Of a node's labels.
  struct Scratch {
    std::vector<float> belief, reduced;
  };

  // The sum of visit(node, scratch) over the nodes with labels. Nodes of a run
  // write to their own edges only: the order of the visits does not matter.
  template <typename Visit>
  double SumOverRun(size_t run, const Visit& visit) const {
    constexpr uint32_t kGrain = 128;  // nodes: a few microseconds of work
    return tbb::parallel_deterministic_reduce(
        tbb::blocked_range<uint32_t>(runs_[run], runs_[run + 1], kGrain), 0.0,
        [&](const tbb::blocked_range<uint32_t>& nodes, double sum) {
          Scratch scratch;
          for (uint32_t node = nodes.begin(); node < nodes.end(); ++node) {
            if (problem_.NumLabels(node) > 0) {
              sum += visit(node, &scratch);
            }
          }
          return sum;
        },
        std::plus<double>());
  }

  bool IsUsed(uint32_t neighbor) const {
    return neighbor != kNone && problem_.NumLabels(neighbor) > 0;
  }

  void AllocateMessages() {
    messages_of_.assign(problem_.NumNodes(), {});
    uint64_t size = 0;
    for (uint32_t node = 0; node < problem_.NumNodes(); ++node) {
      for (int k = 0; k < 3; ++k) {
        const uint32_t neighbor = problem_.neighbors[node][k];
        if (!IsUsed(neighbor) || neighbor < node) {
          continue;
        }
        const auto& back = problem_.neighbors[neighbor];
        const auto place = std::ranges::find(back, node) - back.begin();
        messages_of_[node][k] = size;
        messages_of_[neighbor][place] = size;
        size +=
            std::max(problem_.NumLabels(node), problem_.NumLabels(neighbor));
      }
    }
    messages_.assign(size, 0);
  }

  // The node's costs and the messages of all its neighbors.
  void Collect(uint32_t node, std::vector<float>* belief) const {
    const auto costs = problem_.Costs(node);
    belief->assign(costs.begin(), costs.end());
    for (int k = 0; k < 3; ++k) {
      if (IsUsed(problem_.neighbors[node][k])) {
        AddMessage(messages_of_[node][k], belief);
      }
    }
  }

  void AddMessage(uint64_t at, std::vector<float>* belief) const {
    const float* message = messages_.data() + at;
    for (size_t i = 0; i < belief->size(); ++i) {
      (*belief)[i] += message[i];
    }
  }

  // Chooses the label with the least belief.
  // \return its cost, with the edges to the earlier neighbors
  double Choose(uint32_t node, std::vector<float>* belief,
                std::vector<uint32_t>* choices) const {
    const auto costs = problem_.Costs(node);
    belief->assign(costs.begin(), costs.end());
    const auto labels = problem_.Labels(node);
    std::array<uint32_t, 3> chosen{};  // by the earlier neighbors
    int num_chosen = 0;
    for (int k = 0; k < 3; ++k) {
      const uint32_t neighbor = problem_.neighbors[node][k];
      if (!IsUsed(neighbor)) {
        continue;
      }
      if (neighbor > node) {
        AddMessage(messages_of_[node][k], belief);
        continue;
      }
      const uint32_t label = problem_.Labels(neighbor)[(*choices)[neighbor]];
      for (size_t i = 0; i < belief->size(); ++i) {
        (*belief)[i] += labels[i] == label ? 0 : weight_;
      }
      chosen[num_chosen++] = label;
    }
    const auto best = std::ranges::min_element(*belief);
    const auto choice = static_cast<uint32_t>(best - belief->begin());
    (*choices)[node] = choice;
    const auto num_equal =
        std::count(chosen.begin(), chosen.begin() + num_chosen, labels[choice]);
    return costs[choice] +
           problem_.weight * static_cast<double>(num_chosen - num_equal);
  }

  // Sends messages to the later (or earlier) neighbors, in place of those that
  // came from them.
  // \return the sum of what is subtracted from the messages so that their least
  //         values are 0
  double Send(uint32_t node, bool is_forward, Scratch* scratch) {
    int num_later = 0;
    int num_earlier = 0;
    for (const uint32_t neighbor : problem_.neighbors[node]) {
      if (IsUsed(neighbor)) {
        ++(neighbor > node ? num_later : num_earlier);
      }
    }
    const float share =
        1 / static_cast<float>(std::max({num_later, num_earlier, 1}));
    double subtracted = 0;
    for (int k = 0; k < 3; ++k) {
      const uint32_t neighbor = problem_.neighbors[node][k];
      if (IsUsed(neighbor) && (neighbor > node) == is_forward) {
        subtracted += SendTo(node, neighbor, share, scratch,
                             messages_.data() + messages_of_[node][k]);
      }
    }
    return subtracted;
  }

  // The message to a label is the least of what the node's labels cost, plus
  // the weight for all but the same label.
  float SendTo(uint32_t node, uint32_t neighbor, float share, Scratch* scratch,
               float* message) const {
    const auto from = problem_.Labels(node);
    const auto to = problem_.Labels(neighbor);
    std::vector<float>& reduced = scratch->reduced;
    reduced.resize(from.size());
    float least = std::numeric_limits<float>::max();
    for (size_t i = 0; i < from.size(); ++i) {
      reduced[i] = share * scratch->belief[i] - message[i];
      least = std::min(least, reduced[i]);
    }
    const float other = least + weight_;
    float lowest = other;
    for (size_t i = 0, j = 0; j < to.size(); ++j) {
      while (i < from.size() && from[i] < to[j]) {
        ++i;
      }
      const bool is_common = i < from.size() && from[i] == to[j];
      message[j] = is_common ? std::min(reduced[i], other) : other;
      lowest = std::min(lowest, message[j]);
    }
    for (size_t j = 0; j < to.size(); ++j) {
      message[j] -= lowest;
    }
    return lowest;
  }

  const PottsProblem& problem_;
  float weight_;
  std::vector<uint32_t> runs_;  // [R + 1], into the nodes

  // An edge has one message at a time, to the node whose turn comes next; it is
  // kept with the first of the two nodes.
  std::vector<std::array<uint64_t, 3>> messages_of_;  // [N] into messages_
  std::vector<float> messages_;
};

// Sequential tree-reweighted message passing [Kolmogorov2006], see
// SolvePotts().
// \param solution  with choices and their energy; gets better ones, and the
//        bound
void PassMessages(const PottsProblem& problem, double max_gap,
                  int max_iterations, PottsSolution* solution) {
  // Relative to the bound, from pass to pass. A third of the default max_gap:
  // at a slower rise the gap would take many passes to close.
  constexpr double kMinRise = 3e-4;
  MessagePassing passing(problem);
  std::vector<uint32_t> choices = solution->choices;
  while (solution->iterations < max_iterations) {
    ++solution->iterations;
    const double energy = passing.Forward(&choices);
    if (energy < solution->energy) {
      solution->energy = energy;
      solution->choices = choices;
    }
    const double bound = passing.Backward();
    const double rise = bound - solution->lower_bound;
    solution->lower_bound = std::max(solution->lower_bound, bound);
    if (solution->energy - solution->lower_bound <=
            max_gap * solution->energy ||
        (solution->iterations > 1 && rise < kMinRise * solution->lower_bound)) {
      return;
    }
  }
}

std::vector<uint32_t> CheapestLabels(const PottsProblem& problem) {
  std::vector<uint32_t> choices(problem.NumNodes(), kNone);
  for (uint32_t node = 0; node < problem.NumNodes(); ++node) {
    const auto costs = problem.Costs(node);
    if (!costs.empty()) {
      choices[node] = static_cast<uint32_t>(std::ranges::min_element(costs) -
                                            costs.begin());
    }
  }
  return choices;
}

}  // namespace

std::vector<uint32_t> SweepOrder(const Neighbors& neighbors) {
  const Search search = BreadthFirst(neighbors);
  const std::vector<uint32_t>& classes = search.classes;
  const uint32_t num_classes =
      classes.empty() ? 0 : std::ranges::max(classes) + 1;
  // Nodes of a class stay in the search's order.
  const auto add_all = [&](const auto& add) {
    for (const uint32_t node : search.order) {
      add(classes[node], node);
    }
  };
  return GroupInRows<uint32_t>(num_classes, add_all).values;
}

double PottsEnergy(const PottsProblem& problem,
                   const std::vector<uint32_t>& choices) {
  double energy = 0;
  for (uint32_t node = 0; node < problem.NumNodes(); ++node) {
    if (choices[node] == kNone) {
      continue;
    }
    const uint64_t at = problem.offsets[node] + choices[node];
    energy += problem.costs[at];
    for (const uint32_t neighbor : problem.neighbors[node]) {
      if (neighbor != kNone && neighbor > node && choices[neighbor] != kNone &&
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
  PottsSolution solution;
  solution.choices = CheapestLabels(problem);
  solution.initial_energy = PottsEnergy(problem, solution.choices);
  solution.energy = solution.initial_energy;
  PassMessages(problem, max_gap, max_iterations, &solution);
  solution.energy = PottsEnergy(problem, solution.choices);
  return solution;
}

}  // namespace colmap_ext
