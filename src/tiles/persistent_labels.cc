#include "tiles/persistent_labels.h"

#include <algorithm>
#include <array>

#include <tbb/parallel_for.h>

namespace colmap_ext {
namespace {

uint32_t Clamp(uint32_t capacity) { return std::min(capacity, kMaxCapacity); }

uint32_t PlaceAmong(uint32_t node, const std::array<uint32_t, 4>& nodes) {
  return static_cast<uint32_t>(std::ranges::find(nodes, node) - nodes.begin());
}

// The graph of the part, with a label for all nodes around it: their arcs are
// those of the source or the sink.
FlowCapacities PartOf(NeighborView neighbors, const FlowCapacities& graph,
                      const std::vector<uint8_t>& is_part,
                      bool is_free_around) {
  FlowCapacities part = graph;
  tbb::parallel_for(size_t{0}, graph.size(), [&](size_t node) {
    if (is_part[node] == 0) {
      part.source[node] = 0;
      part.sink[node] = 0;
      part.capacities[node].fill(0);
      return;
    }
    for (uint32_t k = 0; k < 4; ++k) {
      const uint32_t other = neighbors[node][k];
      if (is_part[other] != 0) {
        continue;
      }
      if (is_free_around) {
        const uint32_t back =
            PlaceAmong(static_cast<uint32_t>(node), neighbors[other]);
        part.source[node] =
            Clamp(part.source[node]) + Clamp(graph.capacities[other][back]);
      } else {
        part.sink[node] =
            Clamp(part.sink[node]) + Clamp(graph.capacities[node][k]);
      }
      part.capacities[node][k] = 0;
    }
  });
  return part;
}

}  // namespace

std::vector<uint8_t> PersistentLabels(NeighborView neighbors,
                                      const FlowCapacities& graph,
                                      const std::vector<uint8_t>& is_part) {
  std::vector<uint8_t> labels =
      ComputeMinCut(neighbors, PartOf(neighbors, graph, is_part, false))
          .on_source_side;
  if (std::ranges::find(is_part, 0) == is_part.end()) {
    return labels;
  }
  const std::vector<uint8_t> most =
      ComputeMinCut(neighbors, PartOf(neighbors, graph, is_part, true))
          .on_source_side;
  for (size_t node = 0; node < labels.size(); ++node) {
    if (is_part[node] == 0 || labels[node] != most[node]) {
      labels[node] = kNotKnown;
    }
  }
  return labels;
}

}  // namespace colmap_ext
