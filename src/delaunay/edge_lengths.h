#pragma once

#include <cstdint>
#include <vector>

#include "delaunay/tetrahedralization.h"

namespace colmap_ext {

// A percentile of the lengths of all finite edges, each counted once. Scene
// units; 0 where no edge counts.
// \param percent in [0, 100]
// \param is_left_out [V] 1: edges of the vertex do not count; empty: all do
float EdgeLengthPercentile(const Tetrahedralization& tetrahedra, double percent,
                           const std::vector<uint8_t>& is_left_out = {});

// The lengths themselves, in no particular order.
std::vector<float> EdgeLengths(const Tetrahedralization& tetrahedra,
                               const std::vector<uint8_t>& is_left_out = {});

}  // namespace colmap_ext
