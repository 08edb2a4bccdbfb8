#include "tiles/tile_cut.h"

#include <algorithm>

#include <tbb/parallel_for.h>

namespace colmap_ext {
namespace {

uint32_t Clamp(uint32_t capacity) { return std::min(capacity, kMaxCapacity); }

// The graph of the part with free space beyond: the arcs from there are those
// of the source.
FlowCapacities WithFreeSpaceBeyond(NeighborView neighbors,
                                   const FlowCapacities& graph,
                                   const std::vector<CellPlace>& places) {
  FlowCapacities part = graph;
  tbb::parallel_for(size_t{0}, graph.size(), [&](size_t node) {
    if (places[node] == CellPlace::kBeyond) {
      part[node] = {};
      return;
    }
    for (uint32_t k = 0; k < 4; ++k) {
      const uint32_t other = neighbors[node][k];
      if (places[other] == CellPlace::kBeyond) {
        const uint32_t back =
            PlaceOf(static_cast<uint32_t>(node), neighbors[other]);
        part[node].source =
            Clamp(part[node].source) + Clamp(graph[other].arcs[back]);
        part[node].arcs[k] = 0;
      }
    }
  });
  return part;
}

// Nodes of the part within some rings of the shared ones; -1: all.
std::vector<uint8_t> Band(NeighborView neighbors,
                          const std::vector<CellPlace>& places, int rings) {
  std::vector<uint8_t> is_band(places.size(), 0);
  std::vector<uint32_t> front;
  for (uint32_t node = 0; node < places.size(); ++node) {
    if (places[node] == CellPlace::kShared ||
        (rings < 0 && places[node] == CellPlace::kInner)) {
      is_band[node] = 1;
      front.push_back(node);
    }
  }
  for (int ring = 0; ring < rings; ++ring) {
    std::vector<uint32_t> next;
    for (const uint32_t node : front) {
      for (const uint32_t other : neighbors[node]) {
        if (places[other] == CellPlace::kInner && is_band[other] == 0) {
          is_band[other] = 1;
          next.push_back(other);
        }
      }
    }
    front.swap(next);
  }
  return is_band;
}

}  // namespace

PartLabels LabelPart(NeighborView neighbors, const FlowCapacities& graph,
                     const std::vector<CellPlace>& places, int rings) {
  PartLabels labels;
  labels.guesses = ComputeMinCut(neighbors, graph).on_source_side;
  labels.known = labels.guesses;
  if (std::ranges::find(places, CellPlace::kBeyond) == places.end()) {
    return labels;
  }
  const std::vector<uint8_t> most =
      ComputeMinCut(neighbors, WithFreeSpaceBeyond(neighbors, graph, places))
          .on_source_side;
  const std::vector<uint8_t> is_band = Band(neighbors, places, rings);
  for (size_t node = 0; node < places.size(); ++node) {
    const bool is_sure = most[node] == 0;
    if (places[node] == CellPlace::kBeyond ||
        (!is_sure && is_band[node] != 0)) {
      labels.known[node] = kNotKnown;
    } else if (is_sure) {
      labels.known[node] = kMatter;
    }
  }
  return labels;
}

}  // namespace colmap_ext
