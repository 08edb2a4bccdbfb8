#pragma once

#include <vector>

#include "mesh/vertex_rings.h"

namespace colmap_ext {

// Each vertex's value becomes the mean over its surroundings: some rings of
// neighbors, the nearer ones counting more.
void AverageOverSurroundings(const VertexRings& rings,
                             std::vector<double>* values);

}  // namespace colmap_ext
