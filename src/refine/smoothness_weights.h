#pragma once

#include <vector>

#include "mesh/adjacency.h"

namespace colmap_ext {

// Diffusion on the mesh: ten times in turn each vertex's value becomes the mean
// of the vertex and its neighbors. On a regular mesh that is a
// Gaussian of about two edges' standard deviation on each axis.
// \param values  [V]
void AverageOverSurroundings(const VertexRings& rings,
                             std::vector<double>* values);

// Evidence for the weight of the smoothness, per vertex. Both [V].
struct SmoothnessEvidence {
  // How far the images determine where the vertex is (0 to 1, but for the noise
  // of the estimate), times how often they count the same noise, times the
  // user's factor on the weight.
  std::vector<double> determined;

  // The energy of the smoothness for a weight of 2.
  std::vector<double> roughness;
};

// The weight for which the surface, where the images determine it, is as rough
// as the smoothness expects: sum determined / sum roughness [MacKay1992, the
// evidence for alpha]. Infinite where nothing is rough.
double GlobalWeight(const SmoothnessEvidence& evidence);

// The same for the surroundings of each vertex (AverageOverSurroundings), so
// that a plastered wall becomes smooth although the cornice above it is not:
// [V]. Where the surroundings determine little, the weight is near the global
// one. It is never below half of that: badly matched images leave noise that
// looks like relief.
//
// \param weight  the global one; positive.
std::vector<double> LocalWeights(const VertexRings& rings,
                                 SmoothnessEvidence evidence, double weight);

}  // namespace colmap_ext
