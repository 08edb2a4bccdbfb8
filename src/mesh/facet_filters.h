#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "mesh/triangle_mesh.h"

namespace colmap_ext {

// The length of the longest side of each facet: [F], scene units.
// \pre facet indices are in range
std::vector<float> LongestSides(const TriangleMesh& mesh);

// How long sides may be: `factor` times the given percentile (0 ... 100) of the
// longest sides; without end where the factor is 0 or there are none.
double SideLimit(double factor, double percentile, std::vector<float> sides);

struct DroppedComponents {
  size_t num_components = 0;
  size_t num_facets = 0;
};

// Drops the components, connected through edges, of less than min_facets
// facets.
DroppedComponents DropSmallComponents(size_t min_facets,
                                      std::vector<Facet>* facets);

}  // namespace colmap_ext
