#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "delaunay/cell_graph.h"
#include "delaunay/tetrahedralization.h"
#include "optim/min_cut.h"
#include "scene/point_cloud.h"
#include "scene/progress.h"

namespace colmap_ext {

struct VisibilityWeightOptions {
  double distance_sigma = 1;  // scene units
  double behind_sigma = 1;    // in distance sigmas
  // A place within the hull. A ray that leaves the hull at its vertex ends in
  // the infinite cell over whose facet it goes, as seen from there: this
  // depends on the ray and the hull alone. Nothing: in any infinite cell at the
  // vertex.
  std::optional<Eigen::Vector3d> inner_place = std::nullopt;
};

// What votes: each view of each vertex, compressed sparse rows.
struct Observations {
  std::vector<uint64_t> offsets{0};  // [V + 1], into views and alphas
  std::vector<uint32_t> views;       // ascending in each row
  std::vector<float> alphas;         // weight of each observation
  // [V] 1: the vertex is only an end of rays. These rays vote for free space
  // before and behind it, and not for matter. Empty: there are no such
  // vertices.
  std::vector<uint8_t> is_end{};

  bool IsEnd(size_t vertex) const {
    return !is_end.empty() && is_end[vertex] != 0;
  }

  size_t size() const { return views.size(); }
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
// Adds to graph->capacities, source and sink, after flow was pushed along each
// ray: what every labelling costs is the same, and little is left to push for
// the cut (docs/method.md, section 2.3). Sums of integers: the result does not
// depend on the number of threads. Sums stop growing a little above
// kMaxCapacity.
//
// \param centers [views] camera centres, world frame
// \param free_support  [cells] if given, is overwritten: the sum of the alphas
//        of the rays that pass through the cell before they reach their point,
//        in units of capacity [Jancosek2014]
RayReport AddVisibilityWeights(const Tetrahedralization& tetrahedra,
                               const Observations& observations,
                               const std::vector<Eigen::Vector3d>& centers,
                               const VisibilityWeightOptions& options,
                               FlowCapacities* graph,
                               const Progress& progress = {},
                               std::vector<uint32_t>* free_support = nullptr);

// The same votes of points that are not vertices: what their rays do beyond
// the cells that hold them, to the unit as if they were.
//
// \param points [P] world frame, near each other where they follow each other
// \param observations [P] rows of the points, not of vertices
RayReport AddOuterVisibilityWeights(const Tetrahedralization& tetrahedra,
                                    const std::vector<Eigen::Vector3f>& points,
                                    const Observations& observations,
                                    const std::vector<Eigen::Vector3d>& centers,
                                    const VisibilityWeightOptions& options,
                                    FlowCapacities* graph);

}  // namespace colmap_ext
