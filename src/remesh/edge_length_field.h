#pragma once

#include <vector>

#include "mesh/triangle_mesh.h"

namespace colmap_ext {

// Returns [V] the mean length of the edges at each vertex, scene units;
// smoothed over its neighbors. Zero where a vertex has no facet.
std::vector<float> MeanEdgeLengths(const TriangleMesh& mesh);

// Lowers lengths so that they grow along no edge by more than `gradation` times
// the edge's length.
// \param lengths [V] scene units, may be infinite
// \pre gradation > 0, facet indices < V
void LimitGradation(const TriangleMesh& mesh, float gradation,
                    std::vector<float>* lengths);

}  // namespace colmap_ext
