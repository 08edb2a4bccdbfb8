#pragma once

#include <vector>

#include <Eigen/Core>

#include "scene/images.h"
#include "scene/view.h"

namespace colmap_ext {

// Returns a map without depths, of every stride-th pixel of every such row of
// an image.
// \param width, height  of the image, px
// \param stride  px, > 0
DepthMap EmptyDepths(int width, int height, int stride);

// Returns every stride-th pixel of a map of the whole image.
// \param stride  px, > 0
// \pre map.stride == 1
DepthMap Subsample(const DepthMap& map, int stride);

// Returns the points of `depths` where `mask` has a depth too, world frame, row
// by row.
// \pre both are of the same size
std::vector<Eigen::Vector3f> PointsWhere(const DepthMap& depths,
                                         const DepthMap& mask,
                                         const View& view);

}  // namespace colmap_ext
