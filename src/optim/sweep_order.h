#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace colmap_ext {

// An order to visit a graph's nodes in, each after what its neighbors before it
// have left: by their distance from the first node, so that paths of growing
// order run through the whole graph. Nodes of the same distance are sorted so
// that long runs of the order have no neighbors among them, and can be visited
// at the same time; parts that are not connected run side by side.
//
// \param neighbors  [N] symmetric; kNone: none.
// \return  [N] nodes.
std::vector<uint32_t> SweepOrder(
    const std::vector<std::array<uint32_t, 3>>& neighbors);

}  // namespace colmap_ext
