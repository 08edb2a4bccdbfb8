#include "scene/region.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace colmap_ext {

Region RegionBetween(const Eigen::Vector3d& lower,
                     const Eigen::Vector3d& upper) {
  return {Eigen::Matrix3d::Identity(), (lower + upper) / 2,
          (upper - lower) / 2};
}

Region Grow(const Region& region, double margin) {
  Region grown = region;
  grown.half_sizes.array() += margin;
  return grown;
}

SegmentPart PartInside(const Region& region, const Eigen::Vector3d& start,
                       const Eigen::Vector3d& end) {
  const Eigen::Vector3d from = region.FromCenter(start);
  const Eigen::Vector3d way = region.FromCenter(end) - from;
  SegmentPart part;
  for (int axis = 0; axis < 3; ++axis) {
    const double half = region.half_sizes[axis];
    if (way[axis] == 0) {
      if (std::abs(from[axis]) > half) {
        return {1, 0};
      }
      continue;
    }
    double enter = (-half - from[axis]) / way[axis];
    double leave = (half - from[axis]) / way[axis];
    if (enter > leave) {
      std::swap(enter, leave);
    }
    part.first = std::max(part.first, enter);
    part.second = std::min(part.second, leave);
  }
  return part;
}

}  // namespace colmap_ext
