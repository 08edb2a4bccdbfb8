#pragma once

#include "delaunay/tetrahedralization.h"

namespace colmap_ext {

// A percentile of the lengths of all finite edges, each counted once. Scene
// units.
// \param percent in [0, 100]
// \pre there is a finite edge
float EdgeLengthPercentile(const Tetrahedralization& tetrahedra,
                           double percent);

}  // namespace colmap_ext
