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

// A region that is solved.
struct Solved {
  int64_t flow = 0;
  uint32_t time = 0;
};

// Solves both halves of a region in parallel, and then continues from the
// border between them [Liu2010].
// \param begin, end  consecutive nodes; the arcs between them count
Solved SolveRegion(uint32_t begin, uint32_t end, FlowNetwork* network);

}  // namespace colmap_ext
