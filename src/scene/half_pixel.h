#pragma once

#include <vector>

#include <Eigen/Core>

#include "scene/point_cloud.h"
#include "scene/view.h"

namespace colmap_ext {

// COLMAP's camera models put the centre of the first pixel at (0.5, 0.5), but
// its stereo and fusion [Schoenberger2016] back-project integer pixel indices:
// fused points lie half a pixel up and left in every view (docs/method.md,
// section 1.1).
//
// Returns [P] what has to be added to each point of the cloud, to first order:
// world frame, scene units; zero for a point without views.
// \param depth_map_scales  [views] width of each view's depth map over that of
//        its image; empty if all are 1
// \pre view indices < views.size()
std::vector<Eigen::Vector3f> HalfPixelOffsets(
    const PointCloud& cloud, const std::vector<View>& views,
    const std::vector<double>& depth_map_scales = {});

}  // namespace colmap_ext
