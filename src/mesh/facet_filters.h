#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "mesh/triangle_mesh.h"

namespace colmap_ext {

// Drops the facets with a side longer than `factor` times the given percentile
// (0 ... 100) of the facets' longest sides; none where the factor is 0.
// \return how many
// \pre facet indices are in range
size_t DropLongFacets(double factor, double percentile, TriangleMesh* mesh);

struct DroppedComponents {
  size_t num_components = 0;
  size_t num_facets = 0;
};

// Drops the components, connected through edges, of less than min_facets
// facets.
DroppedComponents DropSmallComponents(size_t min_facets,
                                      std::vector<Facet>* facets);

}  // namespace colmap_ext
