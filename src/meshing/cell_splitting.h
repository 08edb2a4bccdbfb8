#pragma once

#include <cstdint>
#include <vector>

#include "delaunay/tetrahedralization.h"
#include "optim/min_cut.h"

namespace colmap_ext {

// What one of the four parts of a split cell has of its capacities.
// \param part  the one that has the centroid in place of this corner
NodeCapacities PartOf(const NodeCapacities& cell, int part);

// Whether a cell can be split: it is finite, and its centroid, rounded to
// floats, lies within it, so that its parts are positively oriented.
bool CanSplit(const Tetrahedralization& tetrahedra, uint32_t cell);

// Splits a cell into four at its centroid. The cell keeps its index as
// the first of them; the other three are appended to the cells, and the
// centroid to the points. All four have the cell's label. They share out its
// terminal capacities; their outer facets keep its arcs, the arcs between them
// have no capacity: the cut's value stays.
//
// \param tetrahedra is no longer Delaunay afterwards
// \param graph      of the cells: node i is cell i; or nullptr
// \param is_free    [C] labels of the cells, 1: free space, 0: matter
// \pre CanSplit()
void SplitCell(uint32_t cell, Tetrahedralization* tetrahedra,
               FlowCapacities* graph, std::vector<uint8_t>* is_free);

}  // namespace colmap_ext
