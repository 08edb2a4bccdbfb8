#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace colmap_ext {

// Capacities above this one count as this one, so that a signed integer of 32
// bits holds the sum of the residual capacities of an arc and of its reverse.
inline constexpr uint32_t kMaxCapacity = (1u << 30) - 1;

// The capacities of a node's arcs.
struct NodeCapacities {
  std::array<uint32_t, 4> arcs = {};  // to each neighbor
  uint32_t source = 0;                // from the source
  uint32_t sink = 0;                  // to the sink

  bool operator==(const NodeCapacities&) const = default;
};

// [N] The capacities of a directed graph with a source and a sink, whose nodes
// have at most four neighbors: the cells of a tetrahedralization. They are
// integers, so that sums do not depend on their order and a cut equals its flow
// exactly.
using FlowCapacities = std::vector<NodeCapacities>;

// The neighbors of nodes where they lie, in rows of four among other data.
class NeighborView {
 public:
  // \param first   the row of node 0
  // \param stride  from row to row, bytes
  NeighborView(const std::array<uint32_t, 4>* first, size_t stride)
      : first_(reinterpret_cast<const std::byte*>(first)), stride_(stride) {}

  // \param rows  [N] or kNone
  // NOLINTNEXTLINE(google-explicit-constructor): a view, like std::span.
  NeighborView(const std::vector<std::array<uint32_t, 4>>& rows)
      : NeighborView(rows.data(), sizeof(rows[0])) {}

  const std::array<uint32_t, 4>& operator[](size_t node) const {
    return *reinterpret_cast<const std::array<uint32_t, 4>*>(first_ +
                                                             node * stride_);
  }

 private:
  const std::byte* first_;
  size_t stride_;
};

struct MinCut {
  std::vector<uint8_t> on_source_side;  // [N], 1 or 0
  int64_t flow = 0;
};

// Maximum flow and minimum s-t cut: augmenting paths along two search trees
// that are kept and repaired [Boykov2004]. Among the minimum cuts the one with
// the fewest nodes on the source's side, which is unique.
//
// \pre neighbors are symmetric and without repeats
MinCut ComputeMinCut(NeighborView neighbors, const FlowCapacities& capacities);

// The sum of the capacities of the arcs that lead from the source's side to the
// sink's.
int64_t CutValue(NeighborView neighbors, const FlowCapacities& capacities,
                 const std::vector<uint8_t>& on_source_side);

}  // namespace colmap_ext
