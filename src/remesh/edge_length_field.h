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

// Returns [V] the length with which edges stray from the surface by no more
// than a tolerance: sqrt(6 tolerance / curvature - 3 tolerance^2) [Dunyach2013,
// section 3.2], with the largest curvature along the edges of a vertex.
// Infinite where the surface is flat, a vertex has no facet, or its tolerance
// is infinite.
// \param tolerances [V] scene units, positive
// \pre facet indices < V
std::vector<float> LengthsForCurvature(const TriangleMesh& mesh,
                                       const std::vector<float>& tolerances);

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
