#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "optim/potts_mrf.h"

namespace colmap_ext {

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
  explicit MessagePassing(const PottsProblem& problem);

  // A pass in the order. Each node chooses by the choices of its earlier
  // neighbors and the messages of its later ones.
  // \param choices [N] see PottsSolution, are overwritten
  // \return the energy of the choices
  double Forward(std::vector<uint32_t>* choices);

  // A pass against the order.
  // \return a lower bound on the energy
  double Backward();

 private:
  // Of a node's labels.
  struct Scratch {
    std::vector<float> belief, reduced;
  };

  template <typename Visit>
  double SumOverRun(size_t run, const Visit& visit) const;

  bool IsUsed(uint32_t neighbor) const {
    return neighbor != kNone && problem_.NumLabels(neighbor) > 0;
  }

  void AllocateMessages();
  void AddMessage(uint64_t at, std::vector<float>* belief) const;
  void Collect(uint32_t node, std::vector<float>* belief) const;
  double Choose(uint32_t node, std::vector<float>* belief,
                std::vector<uint32_t>* choices) const;
  double Send(uint32_t node, bool is_forward, Scratch* scratch);
  float SendTo(uint32_t node, uint32_t neighbor, float share, Scratch* scratch,
               float* message) const;

  const PottsProblem& problem_;
  float weight_;
  std::vector<uint32_t> runs_;  // [R + 1], into the nodes

  // An edge has one message at a time, to the node whose turn comes next; it is
  // kept with the first of the two nodes.
  std::vector<std::array<uint64_t, 3>> messages_of_;  // [N] into messages_
  std::vector<float> messages_;
};

}  // namespace colmap_ext
