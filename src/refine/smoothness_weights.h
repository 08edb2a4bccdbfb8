#pragma once

#include <vector>

#include "mesh/vertex_rings.h"

namespace colmap_ext {

// What a surface and its images tell of how much its smoothness is to weigh,
// vertex by vertex; 0 where there is no smoothness.
struct SmoothnessEvidence {
  // How far the images determine the vertex's residual (0 ... 1, but for the
  // noise of the estimate), times how often they count the same noise.
  std::vector<double> determined;

  // The smoothness' energy for a weight of 2.
  std::vector<double> roughness;
};

// The weight for which what the images determine is as rough as the prior has
// it: sum determined / sum roughness (MacKay 1992, Bayesian interpolation, the
// evidence for alpha). Infinite where nothing is rough.
double GlobalWeight(const SmoothnessEvidence& evidence);

// The same for the surroundings of each vertex, so that a plastered wall
// becomes smooth although the cornice above it is not: [V]. Where the
// surroundings (refine/surroundings.h) determine little, they have the weight
// of all. It is not much less than that anywhere: where images match badly,
// their noise is as rough as true relief.
//
// \param weight  of all; positive.
std::vector<double> LocalWeights(const VertexRings& rings,
                                 SmoothnessEvidence evidence, double weight);

}  // namespace colmap_ext
