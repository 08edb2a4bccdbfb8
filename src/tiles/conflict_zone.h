#pragma once

#include <cstdint>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "delaunay/growing_complex.h"

namespace colmap_ext {

// Where a point would be in conflict with a cell: the sphere around a finite
// cell, the half-space beyond an infinite one. A little larger, so that no
// rounding leaves out what is in conflict by exact predicates.
class ConflictZone {
 public:
  ConflictZone(const GrowingComplex& complex, uint32_t cell);

  // Whether the zone may reach into a box.
  bool MayTouch(const Eigen::AlignedBox3f& box) const;

  // How deep a point lies within, in the zone's own measure: the deepest one of
  // several makes the smallest zones when it is inserted. Negative: outside.
  double Depth(const Eigen::Vector3f& point) const;

 private:
  bool is_sphere_ = false;
  Eigen::Vector3d center_ = Eigen::Vector3d::Zero();  // of the sphere, or a
                                                      // corner of the facet
  Eigen::Vector3d normal_ = Eigen::Vector3d::Zero();  // unit, of a half-space
  bool has_normal_ = false;  // else nothing is known of where the zone is
  double radius_squared_ = 0;
  double slack_ = 0;  // of distances, scene units
};

}  // namespace colmap_ext
