#pragma once

#include <limits>

#include <Eigen/Core>

namespace colmap_ext {

// A box in any orientation: the part of the world that is wanted.
struct Region {
  // A rotation; its rows are the box's axes.
  Eigen::Matrix3d region_from_world = Eigen::Matrix3d::Identity();
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  // world frame
  Eigen::Vector3d half_sizes = Eigen::Vector3d::Constant(
      std::numeric_limits<double>::infinity());  // along the axes, scene units

  // The point from the centre, along the axes, scene units.
  Eigen::Vector3d FromCenter(const Eigen::Vector3d& point) const {
    return region_from_world * (point - center);
  }

  // Border included.
  bool Contains(const Eigen::Vector3d& point) const {
    return (FromCenter(point).cwiseAbs().array() <= half_sizes.array()).all();
  }
  bool Contains(const Eigen::Vector3f& point) const {
    return Contains(Eigen::Vector3d(point.cast<double>()));
  }
};

// A box along the axes of the world.
Region RegionBetween(const Eigen::Vector3d& lower,
                     const Eigen::Vector3d& upper);

// The region with so much more on each side, scene units.
Region Grow(const Region& region, double margin);

// The part of a segment within a region, as shares of the way from its start to
// its end: empty (first > second) where it misses the region.
struct SegmentPart {
  double first = 0;
  double second = 1;

  bool IsEmpty() const { return first > second; }
};
SegmentPart PartInside(const Region& region, const Eigen::Vector3d& start,
                       const Eigen::Vector3d& end);

}  // namespace colmap_ext
