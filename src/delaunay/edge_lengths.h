#pragma once

#include "delaunay/tetrahedralization.h"

namespace colmap_ext {

// A percentile of the lengths of all finite edges, each counted once.
float EdgeLengthPercentile(const Tetrahedralization& tetrahedra,
                           double percent);

}  // namespace colmap_ext
