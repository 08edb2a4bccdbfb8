#include "scene/region.h"

#include <algorithm>

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

SegmentPart ClipToBox(const Eigen::Vector3d& start, const Eigen::Vector3d& way,
                      const Eigen::Vector3d& lower,
                      const Eigen::Vector3d& upper, SegmentPart part) {
  for (int axis = 0; axis < 3; ++axis) {
    if (way[axis] != 0) {
      const double a = (lower[axis] - start[axis]) / way[axis];
      const double b = (upper[axis] - start[axis]) / way[axis];
      part.first = std::max(part.first, std::min(a, b));
      part.second = std::min(part.second, std::max(a, b));
    } else if (start[axis] < lower[axis] || start[axis] > upper[axis]) {
      return {1, 0};
    }
  }
  return part;
}

SegmentPart PartInside(const Region& region, const Eigen::Vector3d& start,
                       const Eigen::Vector3d& end) {
  const Eigen::Vector3d from = region.FromCenter(start);
  return ClipToBox(from, region.FromCenter(end) - from, -region.half_sizes,
                   region.half_sizes);
}

}  // namespace colmap_ext
