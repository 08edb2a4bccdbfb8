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

// Of that graph, with space for the cells that SplitCell appends.
FlowCapacities ZeroCapacities(const Tetrahedralization& tetrahedra);

// A weight, 0 or more, in units of capacity; at most kMaxCapacity.
uint32_t ToCapacity(double weight);

// Adds atomically, up to a little above kMaxCapacity. Whether the sum ends
// above it does not depend on the order, and above it all sums count the same.
void AddCapacity(uint32_t capacity, uint32_t* sum);

// Adds the surface quality term to the capacities, in both directions of each
// facet [Labatut2009, figure 9]: weight (1 - min(cos phi, cos psi)), phi and
// psi the angles between the facet's plane and the circumscribing spheres of
// its two cells. An infinite cell's cosine is 1.
//
// We deviate between two infinite cells, where the smaller cosine counts as -1:
// where the object is its own hull, rays enter the hull by most infinite cells
// but not by all. The labels of the former then extend to the others, which
// would otherwise be holes.
//
// \param weight of the term, 0 or more
// \param graph  of the cells: node i is cell i; capacities in 1 / kWeightUnit
void AddQualityWeights(const Tetrahedralization& tetrahedra, double weight,
                       FlowCapacities* graph);

// The cosine of the angle between the plane of facet 0 ... 3 of a cell and the
// cell's circumscribing sphere: the signed distance of the sphere's centre from
// the plane, positive on the cell's side, over the radius. 1 for infinite
// cells.
double CosFacetSphereAngle(const Tetrahedralization& tetrahedra, uint32_t cell,
                           int facet);

}  // namespace colmap_ext
