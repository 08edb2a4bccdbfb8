#include "delaunay/visibility_weights.h"

#include <algorithm>
#include <array>

#include <tbb/parallel_for.h>

#include "base/percentile.h"
#include "delaunay/ray_walk.h"

namespace colmap_ext {
namespace {

// Of the median support in front.
constexpr double kMinJump = 0.5;
constexpr double kMaxBehind = 0.01;

// What a vote gets on top of its weight, as a factor of it.
constexpr double kGain = 2;

// The largest support of the cells on a ray's way.
uint32_t LargestSupport(const std::vector<uint32_t>& free_support,
                        const RayPath& path) {
  uint32_t largest = free_support[path.end];
  for (const Crossing& crossing : path.crossings) {
    largest = std::max(largest, free_support[crossing.exit_arc / 4]);
  }
  return largest;
}

}  // namespace

SupportJump MeasureJump(const Tetrahedralization& tetrahedra,
                        const std::vector<uint32_t>& free_support,
                        uint32_t vertex, const Eigen::Vector3d& center,
                        const VisibilityWeightOptions& options) {
  const Eigen::Vector3d position = tetrahedra.PositionOf(vertex);
  const Eigen::Vector3d sigma =
      options.distance_sigma * (position - center).normalized();
  const std::array<Ray, 3> rays = {
      {{vertex, position + options.behind_sigma * sigma},
       {vertex, position - kFrontSigmas * sigma},
       {vertex, position + kBehindSigmas * sigma}}};
  thread_local std::array<RayPath, 3> paths;
  WalkRays(tetrahedra, rays, paths);
  const auto& [extension, front, behind] = paths;
  if (extension.end == kNone || tetrahedra.IsInfinite(extension.end) ||
      front.end == kNone || behind.end == kNone) {
    return {};
  }
  return {LargestSupport(free_support, front),
          LargestSupport(free_support, behind), extension.end};
}

size_t AddWeakSurfaceWeights(const Tetrahedralization& tetrahedra,
                             const Observations& observations,
                             const std::vector<Eigen::Vector3d>& centers,
                             const std::vector<uint32_t>& free_support,
                             const VisibilityWeightOptions& options,
                             FlowCapacities* graph) {
  std::vector<SupportJump> jumps(observations.values.size());
  const auto num_vertices = static_cast<uint32_t>(observations.size());
  tbb::parallel_for(uint32_t{0}, num_vertices, [&](uint32_t vertex) {
    const uint64_t end = observations.offsets[vertex + 1];
    for (uint64_t k = observations.offsets[vertex];
         k < end && !observations.IsEnd(vertex); ++k) {
      jumps[k] = MeasureJump(tetrahedra, free_support, vertex,
                             centers[observations.values[k].view], options);
    }
  });
  std::vector<double> fronts;  // of the rays that are not lost
  for (const SupportJump& jump : jumps) {
    if (jump.end_cell != kNone) {
      fronts.push_back(jump.front);
    }
  }
  // The upper one of two.
  const double median = fronts.empty() ? 0 : Percentile(50, &fronts);
  size_t num_sharp = 0;
  for (size_t k = 0; k < jumps.size(); ++k) {
    const auto& [front, behind, end_cell] = jumps[k];
    const double jump = static_cast<double>(front) - behind;
    if (end_cell != kNone && (behind < kMaxBehind * median) &&
        (jump > kMinJump * median)) {
      ++num_sharp;
      AddCapacity(ToCapacity(kGain * observations.values[k].alpha),
                  &(*graph)[end_cell].sink);
    }
  }
  return num_sharp;
}

}  // namespace colmap_ext
