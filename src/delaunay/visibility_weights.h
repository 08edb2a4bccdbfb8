#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "delaunay/tetrahedralization.h"
#include "optim/min_cut.h"
#include "scene/point_cloud.h"
#include "scene/progress.h"

namespace colmap_ext {

// Capacities are sums of weights in this unit: a weight of one is this integer.
inline constexpr double kWeightUnit = 4096;

struct VisibilityWeightOptions {
  double distance_sigma = 1;  // scene units
  double behind_sigma = 1;    // in distance sigmas
};

// What votes: all points of the cloud, those that were thinned out, too.
struct Observations {
  const PointCloud& cloud;
  // [P] the vertex at the point, or one near it where its cell is searched
  // from.
  const std::vector<uint32_t>& point_vertices;
  const std::vector<float>& alphas;  // [P], weight of each observation
  const std::vector<Eigen::Vector3d>& centers;  // [views], world frame
};

struct RayReport {
  size_t num_rays = 0;       // walked, before and behind their points
  size_t num_lost_rays = 0;  // given up; they contribute nothing
  size_t num_steps = 0;      // facets crossed by all rays
};

// The votes of all observations for free space and matter (Labatut et al. 2009;
// Vu et al. 2012). For a ray from the camera centre c to the point p, seen
// with weight alpha:
//   - the cell of c, or the infinite one through which the ray enters the hull:
//     alpha from the source;
//   - each facet crossed, at distance d from p, in the ray's direction:
//     alpha (1 - exp(-d^2 / (2 sigma^2))), before p and up to behind_sigma
//     sigma behind it;
//   - the cell at that end: alpha to the sink.
// The paper prints 1 - e^(d / 2 sigma), which is never positive.
//
// Adds to graph->capacities, source and sink. Sums of integers: the result does
// not depend on the number of threads. Sums stop growing a little above
// kMaxCapacity.
RayReport AddVisibilityWeights(const Tetrahedralization& tetrahedra,
                               const Observations& observations,
                               const VisibilityWeightOptions& options,
                               FlowGraph* graph, const Progress& progress = {});

// The surface quality term, in both directions of each facet (Labatut et al.
// 2009, figure 9): weight (1 - min(cos phi, cos psi)), phi and psi the angles
// between the facet's plane and the circumscribing spheres of its two cells. An
// infinite cell's cosine is one.
void AddQualityWeights(const Tetrahedralization& tetrahedra, double weight,
                       FlowGraph* graph);

// The cosine of the angle between the facet's plane and the circumscribing
// sphere of its cell: the signed distance of the sphere's centre from the
// plane, positive on the cell's side, over the radius. 1 for infinite cells.
double CosFacetSphereAngle(const Tetrahedralization& tetrahedra, uint32_t cell,
                           int facet);

}  // namespace colmap_ext
