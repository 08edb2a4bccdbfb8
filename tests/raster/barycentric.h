#pragma once

#include "raster/facet_frames.h"

namespace colmap_ext {

// Of a point's projection onto the plane of a facet; they add up to 1.
inline Eigen::Vector3d Barycentric(const FacetFrame& frame,
                                   const Eigen::Vector3d& point) {
  const Eigen::Vector3d from_corner = point - frame.corner;
  const double second = frame.gradient_1.dot(from_corner);
  const double third = frame.gradient_2.dot(from_corner);
  return {1 - second - third, second, third};
}

}  // namespace colmap_ext
