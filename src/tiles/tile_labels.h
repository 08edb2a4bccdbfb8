#pragma once

#include <cstdint>
#include <vector>

#include "optim/min_cut.h"

namespace colmap_ext {

// Label of a cell.
inline constexpr uint8_t kMatter = 0;
inline constexpr uint8_t kFreeSpace = 1;
inline constexpr uint8_t kNotKnown = 2;

// Where a cell lies.
enum class CellPlace : uint8_t {
  kInner,   // all its neighbors are of the part
  kShared,  // of the part, and of others
  kBeyond,  // not of the part
};

// Labels of the nodes of a part of a graph.
struct PartLabels {
  std::vector<uint8_t>
      known;  // [N] one of the above; kNotKnown beyond the part
  std::vector<uint8_t> guesses;  // [N] of the minimum cut of the graph as it is
};

// A node is certainly matter if it is matter even when all nodes beyond the
// part are free space: then it is matter in the minimum cut of the whole graph,
// too, as free space grows with free space around it [Gallo1989]. The opposite
// test is of little use: the votes for free space come along the rays from the
// cameras, which are beyond most parts.
//
// All other nodes of the part are not known within some rings of nodes around
// those that are shared, and further inside have the label of the minimum cut
// of the given graph, which continues beyond the part, but coarsely.
//
// \param graph   complete for the arcs from and to the nodes of the part
// \param places  [N]
// \param rings   -1: all nodes that are not certainly matter are unknown
PartLabels LabelPart(NeighborView neighbors, const FlowCapacities& graph,
                     const std::vector<CellPlace>& places, int rings);

}  // namespace colmap_ext
