#pragma once

#include <cstdint>
#include <vector>

#include "optim/min_cut.h"

namespace colmap_ext {

// What is known of a cell's label.
inline constexpr uint8_t kMatter = 0;
inline constexpr uint8_t kFreeSpace = 1;
inline constexpr uint8_t kNotKnown = 2;

// Labels that the minimum cut of a whole graph gives to nodes of a part of it,
// as far as the part tells: [N] one of the above; kNotKnown outside of the
// part.
//
// The part is cut twice, as if all nodes around it were free space and as if
// all were matter. What one more node of free space around it does is monotone:
// nodes that are free space in spite of matter around them are so in the whole
// graph, and matter likewise [Kolmogorov2007, persistency]. As minimum cuts are
// those with the fewest free nodes (ComputeMinCut), so are these labels.
//
// \param graph    complete for the arcs from and to the nodes of the part
// \param is_part  [N]
std::vector<uint8_t> PersistentLabels(NeighborView neighbors,
                                      const FlowCapacities& graph,
                                      const std::vector<uint8_t>& is_part);

}  // namespace colmap_ext
