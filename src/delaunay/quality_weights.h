#pragma once

#include <cstdint>

#include "delaunay/tetrahedralization.h"
#include "optim/min_cut.h"

namespace colmap_ext {

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
