#pragma once

#include <cstddef>
#include <vector>

#include "mesh/triangle_mesh.h"

namespace colmap_ext {

// Drops the facets whose longest side is more than `factor` times the given
// percentile (0 ... 100) of the longest sides of all. A factor of zero drops
// none. What is left may need SplitFans.
// \return how many were dropped
size_t DropLongFacets(double factor, double percentile, TriangleMesh* mesh);

struct DroppedComponents {
  size_t num_components = 0;
  size_t num_facets = 0;
};

// Drops the components, connected through edges, of fewer than min_facets.
DroppedComponents DropSmallComponents(size_t min_facets, TriangleMesh* mesh);

}  // namespace colmap_ext
