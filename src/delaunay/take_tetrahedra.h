#pragma once

#include <cstdint>
#include <vector>

#include "delaunay/growing_complex.h"
#include "delaunay/tetrahedralization.h"

namespace colmap_ext {

// The tetrahedralization of a complex, with other numbers for the vertices. It
// depends on the points and their numbers alone. The complex is empty
// afterwards.
// \param numbers [P] from 0 on, each once, of the points that are inserted;
//        kNone: of the others
Tetrahedralization TakeTetrahedra(const std::vector<uint32_t>& numbers,
                                  GrowingComplex* complex);

}  // namespace colmap_ext
