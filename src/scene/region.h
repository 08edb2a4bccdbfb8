#pragma once

#include <limits>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "scene/view.h"

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

// \param way  from the start to the end
// \param lower, upper  of a box along the axes
// \param part  of the segment that is clipped
SegmentPart ClipToBox(const Eigen::Vector3d& start, const Eigen::Vector3d& way,
                      const Eigen::Vector3d& lower,
                      const Eigen::Vector3d& upper, SegmentPart part = {});

SegmentPart PartInside(const Region& region, const Eigen::Vector3d& start,
                       const Eigen::Vector3d& end);

// The box of what most views look at. A view looks at the points in its image
// that are at most twice as far as the median of them. Of the points that at
// least half as many views look at as at the best seen ones, the principal axes
// are the box's; it holds all of them but 1 % at each side, and a tenth of its
// size more on each side. The method and its numbers are choices.
//
// \param points  of the scene, e.g. the sparse ones, world frame
// \return nothing where too few points are seen to span a box.
std::optional<Region> FocusRegion(const std::vector<View>& views,
                                  const std::vector<Eigen::Vector3f>& points);

}  // namespace colmap_ext
