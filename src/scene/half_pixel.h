#pragma once

#include <vector>

#include <Eigen/Core>

#include "scene/point_cloud.h"
#include "scene/view.h"

namespace colmap_ext {

// COLMAP's camera models put the centre of the first pixel at (0.5, 0.5), but
// its stereo and fusion back-project integer pixel indices: fused points sit
// half a pixel up and left in every view. To first order a point that views k
// see at depths z_k is off by the mean of z_k (0.5 / fx_k right_k + 0.5 / fy_k
// down_k), in the pixels of the depth maps.
//
// Returns what has to be added to each point of the cloud.
// \param depth_map_scales [views] size of each view's depth map over the size
//        of its image; empty when they are the same.
// \pre view indices < views.size()
std::vector<Eigen::Vector3f> HalfPixelOffsets(
    const PointCloud& cloud, const std::vector<View>& views,
    const std::vector<double>& depth_map_scales = {});

// How far a workspace itself shows that its fused points are off: the
// regression of (sparse point - fused surface), along the surface's normal, on
// what HalfPixelOffsets says there. Sparse points come from features, which do
// not have the error. 1 where the workspace has it, 0 where it does not.
struct HalfPixelSlope {
  double slope = 0;
  double standard_error = 0;
  size_t num_points = 0;  // sparse points that took part; 0 when there are
                          // too few to say anything
};

HalfPixelSlope RegressHalfPixel(
    const PointCloud& cloud, const std::vector<Eigen::Vector3f>& offsets,
    const std::vector<Eigen::Vector3f>& sparse_points);

// By how much the offsets are to be multiplied: the slope that was measured and
// the nominal one, weighted by how certain they are. A cloud that other stereo
// made, with a whole pixel off or none, is so put right as well.
double CalibratedScale(const HalfPixelSlope& slope);

}  // namespace colmap_ext
