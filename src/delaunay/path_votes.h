#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "delaunay/ray_walk.h"
#include "delaunay/tetrahedralization.h"
#include "delaunay/visibility_weights.h"
#include "optim/min_cut.h"

namespace colmap_ext {

// Beyond so many sigmas the soft weight differs from one by exp(-12.5) at most,
// 0.015 of the weights' unit: less than a weight is rounded by.
inline constexpr double kNearSigmas = 5;

// A view of a vertex, or of another point.
struct Observer {
  uint32_t vertex;           // or kNoVertex
  Eigen::Vector3d position;  // of the vertex or point, world frame
  Eigen::Vector3d center;    // of the camera, world frame
  float alpha;               // weight
  bool is_end;               // Observations::is_end
};

// Counts the votes of rays along the paths that they took. Flow is pushed along
// a ray at once (docs/method.md, section 2.3), from both of its ends towards
// the point. Safe from several threads, each with its own.
class PathVotes {
 public:
  PathVotes(const Tetrahedralization& tetrahedra,
            const VisibilityWeightOptions& options, FlowCapacities* graph)
      : tetrahedra_(tetrahedra),
        inner_place_(options.inner_place),
        near_distance_(kNearSigmas * options.distance_sigma),
        normalization_(-0.5 /
                       (options.distance_sigma * options.distance_sigma)),
        graph_(graph) {}

  // The votes of a ray to its camera.
  void AddFront(const Observer& observer, const RayPath& path);
  // Those of a ray on its way behind the point.
  void AddBehind(const Observer& observer, const RayPath& path);
  // Those of a piece of a ray to its camera, far from the point.
  void AddFar(float alpha, const RayPath& path);

 private:
  void AddAtEnds(uint32_t weight, const Observer& observer, const RayPath& path,
                 std::vector<uint32_t>* sums);
  bool GoesOver(uint32_t cell, const Observer& observer,
                const Eigen::Vector3d& target) const;
  void PushAlong(const RayPath& path, const Observer& observer,
                 uint32_t Crossing::*reverse_arc,
                 std::vector<uint32_t>* terminal);
  uint32_t SoftWeight(double alpha, double distance) const;

  void AddToArc(uint32_t weight, uint32_t arc) {
    AddCapacity(weight, &graph_->capacities[arc / 4][arc % 4]);
  }

  const Tetrahedralization& tetrahedra_;
  const std::optional<Eigen::Vector3d> inner_place_;
  const double near_distance_;
  const double normalization_;
  FlowCapacities* graph_;
  std::vector<uint32_t> star_;  // scratch
};

}  // namespace colmap_ext
