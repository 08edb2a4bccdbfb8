#pragma once

#include <vector>

#include "mesh/vertex_rings.h"

namespace colmap_ext {

// Each vertex's value becomes the mean over its surroundings: ten times in
// turn the mean of the vertex and its neighbors. On a regular mesh that is a
// Gaussian of about two edges' standard deviation on each axis.
// \param values  [V]
void AverageOverSurroundings(const VertexRings& rings,
                             std::vector<double>* values);

}  // namespace colmap_ext
