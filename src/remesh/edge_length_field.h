#pragma once

#include <vector>

#include "mesh/triangle_mesh.h"

namespace colmap_ext {

// How fast lengths may grow over the surface: a choice, with which neighboring
// facets hardly differ in size.
inline constexpr float kGradation = 0.3F;

// Returns [V] the mean length of the edges at each vertex, scene units;
// smoothed over its neighbors. Zero where a vertex has no facet.
std::vector<float> MeanEdgeLengths(const TriangleMesh& mesh);

// Lowers lengths so that they grow along no edge by more than `gradation` times
// the edge's length.
// \param lengths [V] scene units, may be infinite
// \pre gradation > 0, facet indices < V
void LimitGradation(const TriangleMesh& mesh, float gradation,
                    std::vector<float>* lengths);

// Returns [V] how far a remeshed surface may stray for facets of such lengths:
// a tenth of them, about as far as the middle of an edge strays from a surface
// whose normals turn by 25 degrees over it.
std::vector<float> TolerancesOf(std::vector<float> lengths);

}  // namespace colmap_ext
