#pragma once

#include <cstddef>
#include <vector>

#include "mesh/triangle_mesh.h"

namespace colmap_ext {

// Drops the facets whose longest side is longer than `factor` times the given
// percentile (0 ... 100) of the longest sides. A factor of 0 drops none. What
// is left may need SplitFans().
// \return the number of facets dropped
// \pre facet indices are in range
size_t DropLongFacets(double factor, double percentile, TriangleMesh* mesh);

struct DroppedComponents {
  size_t num_components = 0;
  size_t num_facets = 0;
};

// Drops the components, connected through edges, of less than min_facets
// facets. Vertices stay.
DroppedComponents DropSmallComponents(size_t min_facets, TriangleMesh* mesh);

}  // namespace colmap_ext
