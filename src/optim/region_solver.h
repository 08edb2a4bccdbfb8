#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/index_limit.h"
#include "optim/min_cut.h"

namespace colmap_ext {

// The parent of a node in its tree: the arc to it, or one of these.
inline constexpr uint8_t kTerminalParent = 4;  // the source or the sink itself
inline constexpr uint8_t kOrphanParent = 5;
inline constexpr uint8_t kNoParent = 6;  // in no tree

struct alignas(32) FlowNode {
  std::array<int32_t, 4> residual;  // of the arcs to the neighbors
  int32_t terminal;                 // > 0: from the source, < 0: to the sink
  uint32_t next_active;             // itself: last in the queue; kNone: not in
  uint32_t stamp;
  uint16_t
      distance;     // to the terminal, at the time `stamp`; UINT16_MAX: or more
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

// Augments paths along two search trees [Boykov2004] within a region of a
// network: consecutive nodes and the arcs between them. The solver of a larger
// region around it starts from the resulting flow and trees.
class RegionSolver {
 public:
  // \param start_time  later than all times at which the nodes got distances
  RegionSolver(FlowNetwork* network, uint32_t begin, uint32_t end,
               uint32_t start_time);

  // In a region where nothing flows yet, all that the terminals reach.
  void ActivateTerminals();

  // In a region of two that are solved, the nodes in trees with arcs from one
  // to the other.
  // \param middle  the first node of the second one
  void ActivateAcross(uint32_t middle);

  void Run();

  int64_t flow() const { return flow_; }
  uint32_t time() const { return time_; }

 private:
  bool IsInside(uint32_t node) const { return node - begin_ < size_; }
  void Activate(uint32_t index);
  void PopActive();
  int32_t Outward(const FlowNode& node, int k, const FlowNode& neighbor) const;
  int32_t Inward(const FlowNode& node, int k, const FlowNode& neighbor) const;
  bool Grow(uint32_t index);
  static void Adopt(FlowNode* child, const FlowNode& parent, int arc_of_parent);
  void Augment(uint32_t from, int arc);
  int32_t Bottleneck(uint32_t index) const;
  void Push(uint32_t index, int32_t amount);
  void MakeOrphan(uint32_t index);
  void FindParent(uint32_t index);
  uint32_t DistanceToTerminal(uint32_t index);

  const NeighborView neighbors_;
  FlowNode* const nodes_;
  const uint32_t begin_;
  const uint32_t size_;
  std::vector<uint32_t> orphans_;
  uint32_t first_active_ = kNone;
  uint32_t last_active_ = kNone;
  uint32_t time_;
  int64_t flow_ = 0;
};

}  // namespace colmap_ext
