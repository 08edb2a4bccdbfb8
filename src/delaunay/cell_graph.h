#pragma once

#include <cstdint>

#include "delaunay/tetrahedralization.h"
#include "optim/min_cut.h"

namespace colmap_ext {

// Capacities per weight: capacities are integers, sums of weights in this unit.
// A power of two, fine enough that rounding moves a weight, which is 1 or less
// for most observations and facets, by 1.2e-4 at most; kMaxCapacity is reached
// at a sum of 262,144.
inline constexpr double kWeightUnit = 4096;

// The graph of the cells: node i is cell i, arc k of a node leads through facet
// k of its cell.
NeighborView NeighborsOf(const Tetrahedralization& tetrahedra);

// Of that graph.
FlowCapacities ZeroCapacities(const Tetrahedralization& tetrahedra);

// A weight, 0 or more, in units of capacity; at most kMaxCapacity.
uint32_t ToCapacity(double weight);

// Adds atomically, up to a little above kMaxCapacity. Whether the sum ends
// above it does not depend on the order, and above it all sums count the same.
void AddCapacity(uint32_t capacity, uint32_t* sum);

}  // namespace colmap_ext
