#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "base/rows.h"
#include "delaunay/tetrahedralization.h"
#include "optim/min_cut.h"
#include "scene/point_cloud.h"
#include "scene/progress.h"

namespace colmap_ext {

// Capacities per weight: capacities are integers, sums of weights in this unit.
// A power of two, fine enough that rounding moves a weight, which is 1 or less
// for most observations and facets, by 1.2e-4 at most; kMaxCapacity is reached
// at a sum of 262,144.
inline constexpr double kWeightUnit = 4096;

// The graph of the cells: node i is cell i, arc k of a node leads through facet
// k of its cell.
NeighborView NeighborsOf(const Tetrahedralization& tetrahedra);

// Of that graph, with space for the cells that SplitCell appends.
FlowCapacities ZeroCapacities(const Tetrahedralization& tetrahedra);

// A weight, 0 or more, in units of capacity; at most kMaxCapacity.
uint32_t ToCapacity(double weight);

// Adds atomically, up to a little above kMaxCapacity. Whether the sum ends
// above it does not depend on the order, and above it all sums count the same.
void AddCapacity(uint32_t capacity, uint32_t* sum);

// Adds the surface quality term to the capacities, in both directions of each
// facet [Labatut2009, figure 9]: weight (1 - min(cos phi, cos psi)), phi and
// psi the angles between the facet's plane and the circumscribing spheres of
// its two cells. An infinite cell's cosine is 1.
//
// We deviate between two infinite cells, where the smaller cosine counts as -1:
// where the object is its own hull, rays enter the hull by most infinite cells
// but not by all. The labels of the former then extend to the others, which
// would otherwise be holes.
//
// \param weight of the term, 0 or more
// \param graph  of the cells: node i is cell i; capacities in 1 / kWeightUnit
void AddQualityWeights(const Tetrahedralization& tetrahedra, double weight,
                       FlowCapacities* graph);

// The cosine of the angle between the plane of facet 0 ... 3 of a cell and the
// cell's circumscribing sphere: the signed distance of the sphere's centre from
// the plane, positive on the cell's side, over the radius. 1 for infinite
// cells.
double CosFacetSphereAngle(const Tetrahedralization& tetrahedra, uint32_t cell,
                           int facet);

struct VisibilityWeightOptions {
  double distance_sigma = 1;  // scene units
  double behind_sigma = 1;    // in distance sigmas
  // A place within the hull. A ray that leaves the hull at its vertex ends in
  // the infinite cell over whose facet it goes, as seen from there: this
  // depends on the ray and the hull alone. Nothing: in any infinite cell at the
  // vertex.
  std::optional<Eigen::Vector3d> inner_place = std::nullopt;
};

// A view of a vertex, and its weight.
struct Observation {
  uint32_t view = 0;
  float alpha = 0;

  // NOLINTNEXTLINE(modernize-use-nullptr): there is no pointer here.
  auto operator<=>(const Observation&) const = default;
};

// What votes: [V] the observations of each vertex, by ascending views.
struct Observations : Rows<Observation> {
  // [V] 1: the vertex is only an end of rays. These rays vote for free space
  // before and behind it, and not for matter. Empty: there are no such
  // vertices.
  std::vector<uint8_t> is_end = {};
  // World frame. Empty: row i is of vertex i. Otherwise row i is of point i,
  // which is not a vertex and lies near point i - 1. Outside the cell that
  // holds the point its rays vote exactly as if it were a vertex.
  std::vector<Eigen::Vector3f> points = {};
  // The rays vote before their points alone, for free space.
  bool are_free = false;

  bool IsEnd(size_t vertex) const {
    return !is_end.empty() && is_end[vertex] != 0;
  }
};

// The observations of a cloud, each at the vertex of its point; those of one
// vertex by one view are one, and their weights add up. COLMAP lets points that
// were thinned out vote by rays of their own. Within the reach of the thinning
// these run side by side: on a scene with known truth the surface is as
// accurate without them, from half to a third of the rays.
//
// \param point_vertices [P] the vertex of each point
// \param point_alphas [P] the weight of each observation of a point
Observations ObserveVertices(const PointCloud& cloud, size_t num_vertices,
                             const std::vector<uint32_t>& point_vertices,
                             const std::vector<float>& point_alphas);

struct RayReport {
  size_t num_rays = 0;       // walked, before and behind their points
  size_t num_lost_rays = 0;  // given up; they contribute nothing
  size_t num_steps = 0;      // facets crossed by all rays

  RayReport& operator+=(const RayReport& other) {
    num_rays += other.num_rays;
    num_lost_rays += other.num_lost_rays;
    num_steps += other.num_steps;
    return *this;
  }
};

// The votes of all observations for free space and matter [Labatut2009; Vu2012;
// Romanoni2020, section IV]. For a ray from the camera centre c to the point p,
// seen with weight alpha:
//   - the cell of c, or the infinite one through which the ray enters the hull:
//     alpha from the source;
//   - each facet crossed, at distance d from p, in the ray's direction:
//     alpha (1 - exp(-d^2 / (2 sigma^2))), before p and up to behind_sigma
//     sigma behind it;
//   - the cell at that end: alpha to the sink.
// Where p is an end of rays, all facets crossed before it and behind it, up to
// the hull, get alpha, and the sink nothing.
// The paper [Romanoni2020] prints 1 - e^(d / 2 sigma), which is never positive.
//
// Adds to the arcs of the nodes and of their terminals, after flow was pushed
// along each ray: what every labelling costs is the same, and little is left to
// push for the cut (docs/method.md, section 2.3). Sums of integers: the result
// does not depend on the number of threads. Sums stop growing a little above
// kMaxCapacity.
//
// \param centers [views] camera centres, world frame
RayReport AddVisibilityWeights(const Tetrahedralization& tetrahedra,
                               const Observations& observations,
                               const std::vector<Eigen::Vector3d>& centers,
                               const VisibilityWeightOptions& options,
                               FlowCapacities* graph,
                               const Progress& progress = {});

}  // namespace colmap_ext
