#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "delaunay/tetrahedralization.h"
#include "delaunay/visibility_weights.h"
#include "optim/min_cut.h"

namespace colmap_ext {

// How free-space support changes along a ray at its vertex.
struct SupportJump {
  uint32_t front = 0;   // the largest support up to kFrontSigmas before it
  uint32_t behind = 0;  // the largest support up to kBehindSigmas behind it
  // Where the ray ends (AddVisibilityWeights); kNone where the ray is lost or
  // ends beyond the hull.
  uint32_t end_cell = kNone;
};

// How far from a vertex support is looked up, in distance sigmas
// [Jancosek2014, k_f and k_b].
inline constexpr double kFrontSigmas = 3;
inline constexpr double kBehindSigmas = 4;

// Measures the jump along the ray from a camera to a vertex.
//
// \param free_support [cells] see AddVisibilityWeights()
// \param center       of the camera, world frame
SupportJump MeasureJump(const Tetrahedralization& tetrahedra,
                        const std::vector<uint32_t>& free_support,
                        uint32_t vertex, const Eigen::Vector3d& center,
                        const VisibilityWeightOptions& options);

// Where free space ends sharply, the rays' votes for matter behind the point
// count three times, so that matter remains whose surface few points support
// [Jancosek2014]. With m, the median over all rays of the support in front, a
// ray's end is sharp if
//   front - behind > m / 2  and  behind < m / 100.
//
// [Jancosek2014] multiplies the capacity by the jump, and its thresholds are
// numbers of rays. Here that is a factor of thousands, which turns the shadows
// of outliers into matter, and numbers of rays depend on the density of the
// points. The largest support behind has to be small, not the smallest, which
// is small behind most points. The factor and the thresholds are tuned on the
// synthetic scenes of docs/method.md, section 2.5.
//
// Only grows graph->sink, of finite cells. Does not depend on the number of
// threads.
//
// \param free_support [cells] of the same observations
// \param centers [views] camera centres, world frame
// \return the number of rays that end sharply
size_t AddWeakSurfaceWeights(const Tetrahedralization& tetrahedra,
                             const Observations& observations,
                             const std::vector<Eigen::Vector3d>& centers,
                             const std::vector<uint32_t>& free_support,
                             const VisibilityWeightOptions& options,
                             FlowCapacities* graph);

}  // namespace colmap_ext
