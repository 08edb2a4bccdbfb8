#pragma once

#include <cstdint>
#include <vector>

#include "delaunay/growing_complex.h"
#include "delaunay/tetrahedralization.h"

namespace colmap_ext {

// The first finite cell of each vertex.
std::vector<uint32_t> FirstCells(const Tetrahedralization& tetrahedra);

// The tetrahedralization of a complex all of whose points are inserted, with
// other numbers for the vertices. It depends on the points and their numbers
// alone. The complex is empty afterwards.
// \param numbers [P] of the points, a permutation
Tetrahedralization TakeTetrahedra(const std::vector<uint32_t>& numbers,
                                  GrowingComplex* complex);

}  // namespace colmap_ext
