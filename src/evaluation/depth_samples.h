#pragma once

#include <vector>

#include <Eigen/Core>

#include "scene/depth_map.h"
#include "scene/view.h"
#include "spatial/bvh.h"

namespace colmap_ext {

// Returns what a view sees of a surface: a ray through the centre of each
// sampled pixel, (col + 0.5, row + 0.5).
// \param stride  px, > 0
DepthMap RenderDepths(const Bvh& surface, const View& view, int stride);

// Returns the same pixels of a map of the whole image.
// \param stride  px, > 0
// \pre map.stride == 1
DepthMap Subsample(const DepthMap& map, int stride);

// Returns the samples of `depths` at which `mask` has a depth as well, as
// points in the world frame, row by row.
// \pre both are of the same size
std::vector<Eigen::Vector3f> PointsWhere(const DepthMap& depths,
                                         const DepthMap& mask,
                                         const View& view);

}  // namespace colmap_ext
