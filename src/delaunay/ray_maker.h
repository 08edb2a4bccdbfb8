#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include <Eigen/Core>

#include "delaunay/ray_walk.h"
#include "delaunay/tetrahedralization.h"
#include "delaunay/visibility_weights.h"

namespace colmap_ext {

// A camera's centre and the cell that holds it.
struct ViewCenter {
  Eigen::Vector3d position;
  uint32_t cell = 0;  // no cell's index where it lies beyond the hull
};

// Moves centres off facets, by a millionth of sigma.
std::vector<ViewCenter> LocateCenters(
    const Tetrahedralization& tetrahedra,
    const std::vector<Eigen::Vector3d>& centers, double sigma);

// Makes the two rays of an observation, from its point to the camera and behind
// it. Distances are asked for where soft weights differ from one. For one
// thread.
class RayMaker {
 public:
  // \param points  that the rays come from; null: the vertices
  // \param part  null: all cells count
  RayMaker(const Tetrahedralization& tetrahedra,
           const std::vector<Eigen::Vector3f>* points,
           const VisibilityWeightOptions& options, const VotingPart* part);

  // Where a point is.
  Eigen::Vector3d PositionOf(uint32_t vertex) const;

  // \param is_end  of rays
  // \return false where nothing of the ray is in the part
  bool ToCenter(uint32_t vertex, const ViewCenter& center, bool is_end,
                Ray* ray);
  bool Behind(uint32_t vertex, const ViewCenter& center, bool is_end, Ray* ray);

  // Has a ray start at its point, not on its way.
  // \return false where it did before
  bool StartAtPoint(uint32_t vertex, Ray* ray);

  double near_distance() const { return near_distance_; }

 private:
  // A place and the cell that has it strictly inside, or an infinite one.
  struct Place {
    Eigen::Vector3d position;
    uint32_t cell = kNoCell;
  };

  const Place& PlaceOf(uint32_t vertex);
  // \param length  of the ray, scene units
  bool Start(uint32_t vertex, double length, Ray* ray);

  const Tetrahedralization& tetrahedra_;
  const std::vector<Eigen::Vector3f>* points_;
  const VisibilityWeightOptions& options_;
  const VotingPart* part_;
  const double near_distance_;
  std::unordered_map<uint32_t, Place> places_;
  uint32_t point_hint_;  // finite cells where one was found before
  uint32_t way_hint_;
};

}  // namespace colmap_ext
