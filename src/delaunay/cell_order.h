#pragma once

#include <vector>

#include "delaunay/growing_complex.h"
#include "delaunay/tetrahedralization.h"

namespace colmap_ext {

// The cells of a complex in an order that depends on their vertices alone, the
// corners of each sorted so that the first two vertices are the lowest. The
// complex has no cells afterwards.
std::vector<Tetrahedralization::Cell> TakeSortedCells(GrowingComplex* complex);

}  // namespace colmap_ext
